// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob_fields.cpp"
