// SPDX-License-Identifier: MIT
#include "../../../../lib/src/number/status.cpp"
