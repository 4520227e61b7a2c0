// SPDX-License-Identifier: MIT
// A library compiled with other bounds on the deviation from nominal: 2 mm and 0.2 rad.
#include <gtest/gtest.h>

#include "tests/blob/support.hpp"

namespace mdhcal {
namespace {

namespace at = blob_layout;

// The first joint of the golden blob has the nominal a = 0.2 m and alpha = -0.35 rad.
Status with(std::size_t parameter, double value) {
  auto bytes = test::copy_of(golden::every_field);
  test::put(bytes, at::joints + at::joint::corrected + 8 * parameter, value);
  return test::decode_repaired(bytes);
}

TEST(Bounds, AreThoseThatTheLibraryWasCompiledWith) {
  EXPECT_EQ(0.002, max_deviation_m());
  EXPECT_EQ(0.2, max_deviation_rad());
  EXPECT_EQ(Status::ok, with(1, 0.2 + 0.0019));
  EXPECT_EQ(Status::blob_deviation, with(1, 0.2 + 0.0021));
  EXPECT_EQ(Status::ok, with(0, -0.35 - 0.19));
  EXPECT_EQ(Status::blob_deviation, with(0, -0.35 - 0.21));
}

}  // namespace
}  // namespace mdhcal
