// SPDX-License-Identifier: MIT
// From a blob's bytes to a calibrated arm in one call.
#include "mdhcal/calibrated_arm.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "mdhcal/kinematics.hpp"
#include "tests/blob/support.hpp"

namespace mdhcal::test {
namespace {

template <class Real>
class Load : public testing::Test {
 protected:
  void SetUp() override { std::memset(static_cast<void*>(arm_.get()), 0x5A, sizeof(CalibratedArm<Real>)); }

  bool untouched() const {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(arm_.get());
    for (std::size_t i = 0; i < sizeof(CalibratedArm<Real>); ++i) {
      if (bytes[i] != 0x5A) return false;
    }
    return true;
  }

  std::unique_ptr<CalibratedArm<Real>> arm_ = std::make_unique<CalibratedArm<Real>>();
};
using Reals = testing::Types<double, float>;
TYPED_TEST_SUITE(Load, Reals, );

TYPED_TEST(Load, GivesTheArmsAndTheDescriptionOfTheBlob) {
  using Real = TypeParam;
  ASSERT_EQ(load(golden::six_joints, blob_size, {}, *this->arm_), Status::self_test_tolerance);  // foreign arithmetic: usable
  BlobContent content;
  ASSERT_EQ(decode(golden::six_joints, blob_size, {}, content), Status::ok);
  Geometry nominal = content.geometry;
  for (std::size_t i = 0; i < max_joints; ++i) nominal.link[i] = content.nominal[i];
  const Real q[max_joints] = {Real(0.25F), Real(-0.5F), Real(0.75F), Real(0.5F), Real(-0.25F), Real(1)};
  const auto table = std::make_unique<JointFunctionTable>();
  make_table(content.transmission, *table);
  Arm<Real> nominal_arm, corrected_arm;
  ASSERT_EQ(make_arm(nominal, nominal_arm), Status::ok);
  ASSERT_EQ(make_arm(content.geometry, content.transmission, *table, corrected_arm), Status::ok);
  const struct { const Arm<Real>& made; const Arm<Real>& arm; } both[] = {{nominal_arm, this->arm_->nominal},
                                                                          {corrected_arm, this->arm_->corrected}};
  for (const auto& one : both) {
    Pose<Real> asked, got;
    ASSERT_EQ(forward(one.made, q, asked), Status::ok);
    ASSERT_EQ(forward(one.arm, q, got), Status::ok);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(asked.quaternion[k], got.quaternion[k]);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(asked.position_m[k], got.position_m[k]);
  }
  EXPECT_STREQ(this->arm_->description.name, content.name);
  EXPECT_STREQ(this->arm_->description.serial, content.serial);
}

// Nothing is half loaded: null, a short blob, a changed byte, another robot's serial, vectors that do not hold.
TYPED_TEST(Load, LeavesTheArmUntouchedWhereItRefuses) {
  EXPECT_EQ(load(nullptr, blob_size, {}, *this->arm_), Status::bad_input);
  EXPECT_TRUE(this->untouched());
  EXPECT_EQ(load(golden::six_joints, blob_size - 1, {}, *this->arm_), Status::blob_size);
  EXPECT_TRUE(this->untouched());
  DecodeOptions other;
  other.serial = "of another robot";
  EXPECT_EQ(load(golden::six_joints, blob_size, other, *this->arm_), Status::blob_serial);
  EXPECT_TRUE(this->untouched());
  Bytes bytes = copy_of(golden::six_joints);
  bytes[200] ^= 1;
  EXPECT_EQ(load(bytes.data(), bytes.size(), {}, *this->arm_), Status::blob_crc);
  EXPECT_TRUE(this->untouched());
}

TYPED_TEST(Load, OptionsOfALoopHaveTheToleranceOfTheBlobAndAStepLimit) {
  using Real = TypeParam;
  ASSERT_TRUE(usable(load(golden::six_joints, blob_size, {}, *this->arm_)));
  const Tolerances& tolerances = this->arm_->description.tolerances;
  const TickOptions<Real> options = default_tick_options(*this->arm_, Real(0.5F));
  const bool is_double = sizeof(Real) == sizeof(double);
  EXPECT_EQ(options.goal.position_tolerance_m,
            is_double ? static_cast<Real>(tolerances.position_m) : static_cast<Real>(tolerances.float_position_m));
  EXPECT_EQ(options.goal.rotation_tolerance_rad,
            is_double ? static_cast<Real>(tolerances.rotation_rad) : static_cast<Real>(tolerances.float_rotation_rad));
  for (int j = 0; j < 6; ++j) {
    EXPECT_GT(options.limits.max_step[j], Real{0});
    EXPECT_LE(options.limits.max_step[j], Real(0.5F) * static_cast<Real>(default_max_velocity_rad_s));
  }
  // A period that is none gives a limit that tick() refuses.
  const Real q[max_joints] = {Real(0.25F), Real(-0.5F), Real(0.75F), Real(0.5F), Real(-0.25F), Real(1)};
  Pose<Real> here;
  ASSERT_EQ(forward(this->arm_->corrected, q, here), Status::ok);
  for (const Real period : {Real{0}, Real{-1}, Real{1001}, std::numeric_limits<Real>::quiet_NaN()}) {
    const TickOptions<Real> none = default_tick_options(*this->arm_, period);
    Real moved[max_joints];
    std::copy(q, q + max_joints, moved);
    EXPECT_EQ(tick(this->arm_->corrected, none, here, moved), Status::bad_input) << period;
  }
}

}  // namespace
}  // namespace mdhcal::test
