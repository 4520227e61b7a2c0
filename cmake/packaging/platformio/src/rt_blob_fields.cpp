// SPDX-License-Identifier: MIT
#include "../../../../lib/src/blob/blob_fields.cpp"
