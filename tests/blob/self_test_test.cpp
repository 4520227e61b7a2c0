// SPDX-License-Identifier: MIT
#include "mdhcal/self_test.hpp"

#include <gtest/gtest.h>

#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "tests/blob/support.hpp"

namespace mdhcal::test {
namespace {

template <class Real>
Real* inverse_of(BlobContent& model) {
  if constexpr (sizeof(Real) == 8) {
    return model.double_vector[1].inverse_q;
  } else {
    return model.float_vector[1].inverse_q;
  }
}

template <class Real>
Pose<Real>& pose_of(BlobContent& model) {
  if constexpr (sizeof(Real) == 8) {
    return model.double_vector[1].base_T_flange;
  } else {
    return model.float_vector[1].base_T_flange;
  }
}

template <class Real>
class SelfTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(decode(golden::six_joints, blob_size, {}, *model), Status::ok);
    prepare();
  }
  void prepare() {
    ASSERT_EQ(make_arm(model->geometry, model->transmission, *table, arm), Status::ok);
    make_table(model->transmission, *table);
  }
  std::unique_ptr<JointFunctionTable> table = std::make_unique<JointFunctionTable>();
  std::unique_ptr<BlobContent> model = std::make_unique<BlobContent>();
  Arm<Real> arm{};
};
using Precisions = testing::Types<double, float>;
TYPED_TEST_SUITE(SelfTest, Precisions);

// The golden vectors are plain 4x4 products under nobody's arithmetic id.
TYPED_TEST(SelfTest, HoldsTheToleranceAgainstForeignArithmetic) {
  EXPECT_EQ(self_test(*this->model, this->arm), Status::self_test_tolerance);
}

TYPED_TEST(SelfTest, FailsBeyondTheTolerance) {
  const TypeParam bound = sizeof(TypeParam) == 8 ? TypeParam(2e-9) : TypeParam(2e-5);
  BlobContent& blob = *this->model;
  inverse_of<TypeParam>(blob)[4] += bound;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
  inverse_of<TypeParam>(blob)[4] -= bound;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_tolerance);
  this->arm.link[3].a_m += bound;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
  this->arm.link[3].a_m -= bound;
  this->arm.link[5].theta_rad += bound;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
}

TYPED_TEST(SelfTest, ComparesBitsUnderItsOwnArithmeticId) {
  BlobContent& blob = *this->model;
  blob.arithmetic_id = arithmetic_id;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed) << "the golden bits are not this library's";
  // Make them so.
  const auto own = [&](auto& vector) {
    for (std::size_t v = 0; v < 2; ++v) {
      ASSERT_EQ(forward(this->arm, vector[v].q, vector[v].base_T_flange), Status::ok);
      TickOptions<TypeParam> options = default_tick_options(this->arm);
      options.goal.position_tolerance_m = sizeof(TypeParam) == 8 ? TypeParam(1e-10) : TypeParam(5e-6F);
      options.goal.rotation_tolerance_rad = options.goal.position_tolerance_m;
      for (std::size_t i = 0; i < 6; ++i) {
        vector[v].inverse_q[i] = vector[v].q[i] + (i % 2 == 0 ? TypeParam(0.015625) : TypeParam(-0.015625));
      }
      ASSERT_EQ(tick(this->arm, options, vector[v].base_T_flange, vector[v].inverse_q), Status::ok);
    }
  };
  if constexpr (sizeof(TypeParam) == 8) {
    own(blob.double_vector);
  } else {
    own(blob.float_vector);
  }
  EXPECT_EQ(self_test(blob, this->arm), Status::ok);
  // Another status fails it.
  blob.double_vector[1].inverse_status = 4;
  blob.float_vector[1].inverse_status = 4;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
  blob.double_vector[1].inverse_status = 0;
  blob.float_vector[1].inverse_status = 0;
  // One bit of one number fails it.
  auto* bits = reinterpret_cast<std::uint8_t*>(pose_of<TypeParam>(blob).position_m);
  bits[0] ^= 1U;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
  bits[0] ^= 1U;
  bits = reinterpret_cast<std::uint8_t*>(inverse_of<TypeParam>(blob));
  bits[0] ^= 1U;
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
}

// written-arithmetic-N-2.0.blob: mdhcal pack of offline/examples/li2022/robot.toml by mdhcal 0.1.0 on an x86-64 host, under
// arithmetic id N, its fields moved to the offsets of format 2. The same bits are due on every machine as long as the arithmetic id stands. If this fails because the
// library's arithmetic changed, give mdhcal/self_test.hpp a new arithmetic_id and add the blob that it writes; the older
// ones stay and are held within the tolerance.
TYPED_TEST(SelfTest, HoldsTheHostsBits) {
  ASSERT_EQ(decode(golden::written_arithmetic_9, blob_size, {}, *this->model), Status::ok);
  ASSERT_EQ(arithmetic_id, this->model->arithmetic_id);
  this->prepare();
  EXPECT_EQ(self_test(*this->model, this->arm), Status::ok);
}

TYPED_TEST(SelfTest, HoldsTheBlobsOfOlderArithmeticWithinTheTolerance) {
  std::uint32_t id = 7;
  for (const std::uint8_t* blob : {golden::written_arithmetic_7, golden::written_arithmetic_8}) {
    ASSERT_EQ(decode(blob, blob_size, {}, *this->model), Status::ok);
    ASSERT_EQ(id++, this->model->arithmetic_id);
    this->prepare();
    EXPECT_EQ(self_test(*this->model, this->arm), Status::self_test_tolerance);
  }
}

TYPED_TEST(SelfTest, FailsWithoutVectors) {
  this->model->double_vector_count = 0;
  this->model->float_vector_count = 0;
  EXPECT_EQ(self_test(*this->model, this->arm), Status::self_test_failed);
}

// Under a foreign arithmetic id an inverse that did not arrive binds nobody; its pose does.
TYPED_TEST(SelfTest, LeavesOutForeignInversesThatDidNotArrive) {
  BlobContent& blob = *this->model;
  blob.double_vector[1].inverse_status = 5;
  blob.float_vector[1].inverse_status = 5;
  inverse_of<TypeParam>(blob)[0] += TypeParam(0.5);
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_tolerance);
  pose_of<TypeParam>(blob).position_m[0] += TypeParam(0.5);
  EXPECT_EQ(self_test(blob, this->arm), Status::self_test_failed);
}

}  // namespace
}  // namespace mdhcal::test
