// SPDX-License-Identifier: MIT
// Whether the residual goes with something that was recorded beside the measurements: reported, not modelled.
#pragma once

#include <string>
#include <vector>

#include "offline/identify/calibrate.hpp"

namespace mdhcal::offline {

/// Whether chance alone explains `p_value` is decided here: one calibration in a thousand claims what is not there.
inline constexpr double dependence_level = 1e-3;

/// Residuals of the good training rows against the temperature column: a shift along each tracker axis and a growth of
/// the arm about its base, all four in proportion to the temperature.
Dependence temperature_dependence(const Calibration& calibration);

/// The same against the direction of approach, a word at a time: every revolute joint off by one angle where the word
/// stands, as backlash makes it.
std::vector<Dependence> direction_dependences(const Calibration& calibration);

/// The sentences to be said; only dependences beyond chance have one.
std::vector<std::string> sentences_on(const std::vector<Dependence>& dependences);

}  // namespace mdhcal::offline
