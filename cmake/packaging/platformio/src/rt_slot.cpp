// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob/slot.cpp"
