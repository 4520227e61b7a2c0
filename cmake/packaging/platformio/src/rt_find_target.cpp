// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob/find_target.cpp"
