// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/inverse/velocities.cpp"
