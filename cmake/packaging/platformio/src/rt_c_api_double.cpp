// SPDX-License-Identifier: MIT
#define MDHCAL_REAL double
#include "../../../../lib/src/c_api.cpp"
