// SPDX-License-Identifier: MIT
#include "../../../../lib/src/crc32.cpp"
