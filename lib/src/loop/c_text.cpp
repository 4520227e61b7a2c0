// SPDX-License-Identifier: MIT
#include "mdhcal.h"
#include "mdhcal/status.hpp"

extern "C" const char* mdhcal_status_text(std::int32_t status) { return mdhcal::status_text(static_cast<mdhcal::Status>(status)); }
