// SPDX-License-Identifier: MIT
#include "mdhcal.h"
#include "mdhcal/environment.hpp"
#include "mdhcal/status.hpp"

extern "C" {

const char* mdhcal_status_text(std::int32_t status) { return mdhcal::status_text(static_cast<mdhcal::Status>(status)); }

std::int32_t mdhcal_usable(std::int32_t status) { return mdhcal::usable(static_cast<mdhcal::Status>(status)) ? 1 : 0; }

std::int32_t mdhcal_check_environment(void) { return static_cast<std::int32_t>(mdhcal::check_environment()); }

}  // extern "C"
