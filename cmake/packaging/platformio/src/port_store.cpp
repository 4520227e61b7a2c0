// SPDX-License-Identifier: MIT
#include "../../../../port/src/store.cpp"
