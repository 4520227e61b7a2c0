// SPDX-License-Identifier: MIT
#include "../../../../lib/src/status.cpp"
