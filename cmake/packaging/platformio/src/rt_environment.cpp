// SPDX-License-Identifier: MIT
#include "../../../../lib/src/environment.cpp"
