// SPDX-License-Identifier: MIT
// A consumer as the library must survive it: compiled -O3 -march=native -ffast-math, with vectorised Eigen in its own
// code, linked with the library. Prints its own Eigen figure and the golden hashes, which must be the tests' own.
#include <cstdio>
#include <cstdlib>

#include <Eigen/Dense>

#include "tests/lib/golden.hpp"

int main(int argc, char** argv) {
  const int operations = argc > 1 ? std::atoi(argv[1]) : 1000;
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (int i = 1; i < 50; ++i) {
    turn = turn * Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitX()));
    a += 0.01 * (a * a.transpose()).cwiseSqrt();
    a /= a.norm();
  }
  std::printf("own %.6f %.6f\n", a.partialPivLu().determinant(), turn.w());
  std::printf("double %016llx\n", static_cast<unsigned long long>(mdhcal::test::golden_hash<double>(operations)));
  std::printf("float %016llx\n", static_cast<unsigned long long>(mdhcal::test::golden_hash<float>(operations)));
  return 0;
}
