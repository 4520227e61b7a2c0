// SPDX-License-Identifier: MIT
#include "../../../../lib/src/slot.cpp"
