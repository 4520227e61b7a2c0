// SPDX-License-Identifier: MIT
#include "../../../../lib/src/number/environment.cpp"
