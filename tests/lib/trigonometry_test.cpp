// SPDX-License-Identifier: MIT
#include "lib/src/number/trigonometry.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/lib/arms.hpp"

namespace {

using namespace mdhcal;
using namespace mdhcal::test;

// The reference is the host's long double (64 bits of significand on x86-64, 113 on AArch64); where long double is
// double, as on bare metal, the bound is one unit wider, since the reference itself is rounded.
constexpr bool wide_reference = std::numeric_limits<long double>::digits > 53;

template <class Real>
long double ulps(Real got, long double truth) {
  int exponent = 0;
  (void)std::frexp(truth, &exponent);
  const int digits = std::numeric_limits<Real>::digits;
  const long double unit = std::ldexp(1.0L, std::max(exponent, std::numeric_limits<Real>::min_exponent) - digits);
  return std::fabs(static_cast<long double>(got) - truth) / unit;
}

template <class Real>
constexpr long double bound = wide_reference || sizeof(Real) == 4 ? 1.0L : 2.0L;

template <class Real>
class Trigonometry : public ::testing::Test {
 protected:
  static void check(Real x) {
    Real sine = 0;
    Real cosine = 0;
    sin_cos(x, sine, cosine);
    ASSERT_LE(ulps(sine, std::sin(static_cast<long double>(x))), bound<Real>) << static_cast<double>(x);
    ASSERT_LE(ulps(cosine, std::cos(static_cast<long double>(x))), bound<Real>) << static_cast<double>(x);
  }
};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Trigonometry, Reals, );

TYPED_TEST(Trigonometry, SineAndCosineToOneUnitOverTheWholeRange) {
  Random random(11);
  for (const double range : {1.0, 8.0, 50.0, 1000.0, 1.0e6}) {
    for (int n = 0; n < cases(200000); ++n) this->check(static_cast<TypeParam>(random.symmetric(range)));
  }
  for (double x = 1.0; x > 1e-30; x *= 0.37) {
    this->check(static_cast<TypeParam>(x));
    this->check(static_cast<TypeParam>(-x));
  }
}

// The hardest arguments: the floating-point numbers nearest to every multiple of pi/2 in the range.
TYPED_TEST(Trigonometry, SineAndCosineNextToEveryQuarterTurn) {
  if (!wide_reference) return;  // the reference needs pi to more than double
  const long double quarter = 1.57079632679489661923132169163975144L;
  for (int k = 0; k < 636000; k += k < 5000 ? 1 : 97) {
    const TypeParam x = static_cast<TypeParam>(static_cast<long double>(k) * quarter);
    if (x > TypeParam(1e6)) break;
    this->check(x);
    this->check(-x);
    this->check(std::nextafter(x, TypeParam(0)));
  }
}

TYPED_TEST(Trigonometry, SineAndCosineOutsideTheRangeAreNaN) {
  using Real = TypeParam;
  for (const Real x : {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity(),
                       -std::numeric_limits<Real>::infinity(), Real(1.1e6), std::numeric_limits<Real>::max()}) {
    Real sine = 0;
    Real cosine = 0;
    sin_cos(x, sine, cosine);
    EXPECT_TRUE(std::isnan(sine) && std::isnan(cosine));
  }
}

TYPED_TEST(Trigonometry, ArcTangentToOneUnitInEveryDirection) {
  using Real = TypeParam;
  Random random(12);
  for (int n = 0; n < cases(400000); ++n) {
    const double scale = std::pow(10.0, random.symmetric(sizeof(Real) == 8 ? 90.0 : 10.0));
    const double other = n % 2 == 0 ? scale : scale * std::pow(10.0, random.symmetric(2.0));
    const Real x = static_cast<Real>(random.symmetric(scale));
    const Real y = static_cast<Real>(random.symmetric(other));
    const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    ASSERT_LE(ulps(arc_tangent(y, x), truth), bound<Real>) << static_cast<double>(y) << " " << static_cast<double>(x);
  }
  const Real edges[] = {Real(0), Real(1), Real(-1), Real(0.4375), Real(0.6875), Real(0.5), Real(2), Real(-0.4375)};
  for (const Real x : edges) {
    for (const Real y : edges) {
      const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
      EXPECT_LE(ulps(arc_tangent(y, x), truth), bound<Real>);
    }
  }
}

TYPED_TEST(Trigonometry, ArcCosineToTwoUnits) {
  using Real = TypeParam;
  Random random(13);
  for (int n = 0; n < cases(200000); ++n) {
    const Real x = static_cast<Real>(random.symmetric(1.0));
    ASSERT_LE(ulps(arc_cosine(x), std::acos(static_cast<long double>(x))), 2 * bound<Real>) << static_cast<double>(x);
  }
  EXPECT_EQ(arc_cosine(Real(1)), Real(0));
  EXPECT_EQ(arc_cosine(Real(2)), Real(0));
}

}  // namespace
