// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/kinematics.cpp"
