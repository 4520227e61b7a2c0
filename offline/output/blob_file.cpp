// SPDX-License-Identifier: MIT
#include "offline/output/blob_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mdhcal/calibrated_arm.hpp"
#include "offline/base/error.hpp"
#include "offline/base/read_file.hpp"

namespace mdhcal::offline {

BlobFile read_blob_file(const std::string& path) {
  const std::string text_bytes = read_file(path, "a parameter blob", 1U << 20U);
  BlobFile file;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(text_bytes.data());
  const Status status = decode(bytes, text_bytes.size(), DecodeOptions{}, file.model);
  if (status != Status::ok) {
    throw InputError(path, 0, 0,
                     "The blob is refused: " + std::string(status_text(status)) + "; found " + std::to_string(text_bytes.size()) +
                         " bytes, expected a parameter blob of " + std::to_string(blob_size) + ".");
  }
  std::memcpy(file.bytes.data(), bytes, file.bytes.size());
  return file;
}

void require_loadable(const BlobFile& file, const std::string& path) {
  const auto require = [&](Status status, const char* precision) {
    if (status == Status::ok || status == Status::self_test_tolerance) return;
    throw InputError(path, 0, 0, std::string("A controller would refuse this blob in ") + precision + " precision: " +
                                     status_text(status) + "; expected one that mdhcal calibrate or pack wrote.");
  };
  // A blob without any vectors fails the self-test of both; one with vectors of one precision is meant for that one.
  if (file.model.double_vector_count > 0 || file.model.float_vector_count == 0) {
    CalibratedArm<double> arm;
    require(load(file.bytes.data(), file.bytes.size(), DecodeOptions{}, arm), "double");
  }
  if (file.model.float_vector_count > 0) {
    CalibratedArm<float> arm;
    require(load(file.bytes.data(), file.bytes.size(), DecodeOptions{}, arm), "float");
  }
}

mdhcal::BlobContent read_blob(const std::string& path) { return read_blob_file(path).model; }

std::string accepted_reason(const BlobProvenance& provenance) {
  const std::string text = provenance.lambda_rule;
  return text.starts_with(accepted_mark) ? text.substr(accepted_mark.size()) : std::string();
}

Robot robot_of(const mdhcal::BlobContent& model, const std::string& path) {
  Robot robot;
  robot.path = path;
  robot.name = model.name;
  robot.serial = model.serial;
  robot.geometry = model.geometry;
  robot.transmission = model.transmission;
  const double* down = model.transmission.gravity.direction;
  if (std::abs(down[0]) > 0 || std::abs(down[1]) > 0 || std::abs(down[2]) > 0) robot.gravity_direction = {down[0], down[1], down[2]};
  std::copy(std::begin(model.nominal), std::end(model.nominal), robot.nominal.begin());
  if (model.has_base == 1) robot.tracker_T_base = model.tracker_T_base;
  for (std::int32_t k = 0; k < model.target_count; ++k) {
    const double* p = model.target[k].flange_p_m;
    robot.targets.push_back({model.target[k].name, {p[0], p[1], p[2]}});
  }
  return robot;
}

}  // namespace mdhcal::offline
