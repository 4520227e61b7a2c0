// SPDX-License-Identifier: MIT
// All of the real-time library.
#pragma once

#include "mdhcal/arm.hpp"
#include "mdhcal/blob.hpp"
#include "mdhcal/calibrated_arm.hpp"
#include "mdhcal/compensator.hpp"
#include "mdhcal/environment.hpp"
#include "mdhcal/geometry.hpp"
#include "mdhcal/inverse.hpp"
#include "mdhcal/kinematics.hpp"
#include "mdhcal/pose.hpp"
#include "mdhcal/self_test.hpp"
#include "mdhcal/solutions.hpp"
#include "mdhcal/status.hpp"
#include "mdhcal/transmission.hpp"
#include "mdhcal/velocities.hpp"
