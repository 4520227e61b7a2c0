// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "offline/output/blob_writer.hpp"

namespace mdhcal::offline {

/// A blob file that lib's decoder accepts.
struct BlobFile {
  Blob bytes{};
  mdhcal::BlobContent model{};
};

/// The bytes and the model of a blob file. Throws InputError naming the file and the reason of the refusal.
BlobFile read_blob_file(const std::string& path);

/// Throws InputError, naming the file and the reason, unless the loader of the library takes the blob: what decode() asks for,
/// an arm of its geometry, and the self-test in each precision of which the blob has vectors (in one at least).
void require_loadable(const BlobFile& file, const std::string& path);

/// The model in a blob file, decoded by lib. Throws InputError naming the file and the reason of the refusal.
mdhcal::BlobContent read_blob(const std::string& path);

/// Why a result with reasons against it was used all the same (`calibrate --accept`), as far as the blob has room for it;
/// empty if there were no reasons. It stands in `lambda_rule`, behind accepted_mark.
inline constexpr std::string_view accepted_mark = "accepted: ";
std::string accepted_reason(const BlobProvenance& provenance);

/// The robot that a model describes: corrected and nominal geometry, base and target points; millimetres and degrees.
Robot robot_of(const mdhcal::BlobContent& model, const std::string& path);

}  // namespace mdhcal::offline
