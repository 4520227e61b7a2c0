// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

#include "offline/measure/dataset.hpp"

namespace mdhcal::offline {

/// A data set as a measurement file: comma-separated, millimetres and degrees stated in the header, the shortest
/// decimals that read back as the same doubles. The columns `group`, `target`, `sigma_mm` and the quaternion are
/// there if the data need them. Rows of kind distance are not for this writer (std::invalid_argument). `progress`, if
/// given, is called with the rows done and all of them.
std::string measurement_text(const Dataset& dataset, const Robot& robot,
                             const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace mdhcal::offline
