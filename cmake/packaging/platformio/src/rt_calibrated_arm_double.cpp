// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/blob/calibrated_arm.cpp"
