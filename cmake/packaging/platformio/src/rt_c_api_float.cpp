// SPDX-License-Identifier: MIT
#define MDHCAL_REAL float
#include "../../../../lib/src/c_api.cpp"
