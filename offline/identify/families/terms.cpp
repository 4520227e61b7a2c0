// SPDX-License-Identifier: MIT
#include "offline/identify/families/terms.hpp"

#include <cmath>

namespace mdhcal::offline {

namespace {

float& coefficient(JointFunction& function, const Term& term) { return (term.sine ? function.sine_rad : function.cosine_rad)[term.index - 1]; }

}  // namespace

TermFamily family_of_order(std::size_t order) {
  return order <= 2 ? TermFamily::orders_1_2 : order <= 10 ? TermFamily::orders_3_10 : order <= 20 ? TermFamily::orders_11_20 : TermFamily::orders_21_40;
}

double value(const Transmission& transmission, const Term& term) {
  if (term.family == TermFamily::gravity) return transmission.gravity.compliance[term.joint][term.index];
  const JointFunction& function = transmission.function[term.joint];
  return static_cast<double>((term.sine ? function.sine_rad : function.cosine_rad)[term.index - 1]);
}

void add_value(Transmission& transmission, const Term& term, double by) {
  if (term.family == TermFamily::gravity) {
    transmission.gravity.compliance[term.joint][term.index] += by;
    return;
  }
  JointFunction& function = transmission.function[term.joint];
  float& c = coefficient(function, term);
  c = static_cast<float>(static_cast<double>(c) + by);
  if (function.order_count < term.index) function.order_count = term.index;
}

double window_at(const JointFunction& function, double reading_rad) {
  JointFunction one = function;
  one.order_count = 1;
  double across = 0.0, along = 0.0, slope = 0.0;
  one.cosine_rad[0] = 1.0F;
  one.sine_rad[0] = 0.0F;
  evaluate_joint_function(one, reading_rad, across, slope);
  one.cosine_rad[0] = 0.0F;
  one.sine_rad[0] = 1.0F;
  evaluate_joint_function(one, reading_rad, along, slope);
  return across * std::cos(reading_rad) + along * std::sin(reading_rad);
}

}  // namespace mdhcal::offline
