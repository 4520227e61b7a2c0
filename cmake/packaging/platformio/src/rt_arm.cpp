// SPDX-License-Identifier: MIT
#include "../../../../lib/src/arm/arm.cpp"
