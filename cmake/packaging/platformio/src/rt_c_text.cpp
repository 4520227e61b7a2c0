// SPDX-License-Identifier: MIT
#include "../../../../lib/src/loop/c_text.cpp"
