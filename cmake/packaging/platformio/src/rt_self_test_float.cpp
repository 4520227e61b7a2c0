// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/self_test.cpp"
