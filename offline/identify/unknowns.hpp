// SPDX-License-Identifier: MIT
// From a robot and its measurements to the unknowns and their starting values.
#pragma once

#include "offline/identify/fit.hpp"

namespace mdhcal::offline {

struct UnknownsOptions {
  bool fit_base = true;
  bool fit_tool = true;
  ParameterChoice parameters;
  double noise_mm = 0.02;
};

struct Unknowns {
  ParameterList parameters;
  Layout layout;       ///< base, targets and geometry
  Layout frames;       ///< base and targets alone
  Estimate nominal;    ///< nominal geometry, base as stated or identity, targets as stated or the tool point
};

/// Decides the unknowns. A target takes its nominal point from [[target]] of its name, else from [tool], else the flange
/// origin. `rows` are the rows to identify from. Throws InputError (see choose_parameters()), and if `--tool given` is
/// asked for a robot file that states no such point for a named target.
Unknowns choose_unknowns(const Robot& robot, const Dataset& data, const std::vector<std::size_t>& rows,
                 const UnknownsOptions& options);

/// Base and targets fitted to the nominal geometry (method NC), robustly, from the best of the closed-form starts.
Fit fit_frames(const Unknowns& unknowns, const Dataset& data, Selection& selection, double noise_mm);

}  // namespace mdhcal::offline
