// SPDX-License-Identifier: MIT
// Private to lib. Between the precisions, for what is asked once: in the objects of double and float alike, so that those of
// float need no unit for double.
#pragma once

namespace mdhcal {

void convert(double from, double& to) noexcept;
void convert(float from, double& to) noexcept;
void convert(double from, float& to) noexcept;

}  // namespace mdhcal
