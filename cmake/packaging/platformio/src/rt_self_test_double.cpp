// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/blob/self_test.cpp"
