// SPDX-License-Identifier: MIT
// Which parameters the poses determine, which they do not, and which are confounded with which.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "offline/identify/model.hpp"

namespace mdhcal::offline {

/// Observability indices of the identifiable part of the column-scaled Jacobian with singular values s_1 ... s_r from m
/// rows: O1 = (s_1 ... s_r)^(1/r) / sqrt(m) (Borm and Menq), O2 = s_r / s_1 (Driels and Pathre), O3 = s_r (Nahvi and
/// others), O4 = s_r^2 / s_1 (Nahvi and Hollerbach), O5 = 1 / sum(1 / s_i) (Sun and Hollerbach).
using ObservabilityIndices = std::array<double, 5>;

/// A combination of parameters that the poses tell little or nothing of.
struct WeakDirection {
  double relative_singular_value = 0;       ///< against the largest; 0 where lost altogether
  std::vector<std::string> members;         ///< parameters that share it, largest share first
  std::string advice;                       ///< what would separate them, a sentence
};

struct Spectrum {
  std::vector<double> singular_values;      ///< column-scaled, base and targets projected out, descending [mm]
  std::size_t rank = 0;
  std::size_t scalar_rows = 0;
  double condition = 0;                     ///< s_1 / s_r
  ObservabilityIndices observability{};
};

struct Identifiability {
  Spectrum before;                          ///< at the nominal geometry
  Spectrum after;                           ///< at the result
  double condition_regularized = 0;         ///< of the stacked system [A; sqrt(lambda) I], prior-scaled
  std::vector<bool> identifiable;           ///< one a parameter
  std::vector<double> resolution;           ///< one a parameter: 1 all from the measurements, 0 all from the prior
  std::vector<WeakDirection> weak;          ///< lost directions, then those below 1/100 of the largest
  std::size_t frame_unknowns = 0;           ///< base and targets
  std::size_t frame_rank = 0;               ///< less than frame_unknowns: base and targets cannot all be told
};

}  // namespace mdhcal::offline
