// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/blob/calibrated_arm.cpp"
