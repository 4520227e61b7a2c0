// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/inverse/velocities.cpp"
