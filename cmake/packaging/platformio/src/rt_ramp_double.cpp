// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/loop/ramp.cpp"
