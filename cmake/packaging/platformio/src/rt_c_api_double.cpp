// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/loop/c_api.cpp"
