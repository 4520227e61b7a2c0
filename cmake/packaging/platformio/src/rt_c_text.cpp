// SPDX-License-Identifier: MIT
#include "../../../../lib/src/c_text.cpp"
