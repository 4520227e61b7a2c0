// SPDX-License-Identifier: MIT
// Prints what each function costs: a line a function, precision and input set.
#include "meter.hpp"

int main() {
  using namespace footprint;
  start_counter();
  measure_arm();
  measure_compensator();
  measure_blob();
  measure_c_api();
}
