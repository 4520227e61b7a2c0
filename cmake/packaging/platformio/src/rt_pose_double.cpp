// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/arm/pose.cpp"
