// SPDX-License-Identifier: MIT
#include "../../../../lib/src/arm/transmission.cpp"
