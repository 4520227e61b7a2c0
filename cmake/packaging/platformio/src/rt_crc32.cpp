// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob/crc32.cpp"
