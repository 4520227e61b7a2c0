// SPDX-License-Identifier: MIT
#pragma once

#include "mdhcal/blob.hpp"

namespace mdhcal::offline {

/// Fills a model's self-test vectors, in double and in float from the same readings, through lib on this machine, and names
/// lib's arithmetic id. The readings are drawn within the joint limits from a fixed seed and are the best conditioned
/// ones of the draw, so that another arithmetic comes to the same joints. The rest of the model must be complete.
void fill_self_test_vectors(BlobContent& model);

}  // namespace mdhcal::offline
