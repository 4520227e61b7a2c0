// SPDX-License-Identifier: MIT
// Four classical discrete ill-posed problems, written from their published definitions (P. C. Hansen, Regularization
// Tools, Numerical Algorithms 6, 1994, and the papers cited there).
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace mdhcal::tests {

struct IllPosed {
  std::string name;
  Eigen::MatrixXd a;
  Eigen::VectorXd x;  ///< true solution
  Eigen::VectorXd b;  ///< a x
};

IllPosed shaw(Eigen::Index n);       ///< one-dimensional image restoration (Shaw 1972); n even
IllPosed phillips(Eigen::Index n);   ///< (Phillips 1962), Galerkin; n a multiple of 4
IllPosed gravity(Eigen::Index n);    ///< gravity surveying at depth 0.25 (Wing and Zahrt 1991)
IllPosed i_laplace(Eigen::Index n);  ///< inverse Laplace transform of exp(-t/2), Gauss-Laguerre (Varah 1983)
std::vector<IllPosed> ill_posed_problems(Eigen::Index n);

}  // namespace mdhcal::tests
