// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/blob/self_test.cpp"
