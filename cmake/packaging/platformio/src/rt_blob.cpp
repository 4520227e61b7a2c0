// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob/blob.cpp"
