// SPDX-License-Identifier: MIT
#include "tests/fuzz/targets.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <set>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

#include "mdhcal.h"
#include "mdhcal/arm.hpp"
#include "mdhcal/crc32.hpp"
#include "offline/base/error.hpp"
#include "offline/batch/batch.hpp"
#include "offline/measure/dataset.hpp"
#include "offline/measure/joint_file.hpp"
#include "offline/output/blob_writer.hpp"
#include "offline/output/sign.hpp"
#include "offline/robot/ur_factory.hpp"
#include "offline/robot/urdf.hpp"
#include "tests/fuzz/blob_invariants.hpp"

namespace mdhcal::fuzz {

namespace {

using offline::InputError;
using offline::Refusal;

[[noreturn]] void stop(const char* what) {
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

void decode_once(const std::uint8_t* bytes, std::size_t size) {
  const auto model = std::make_unique<BlobContent>();
  const auto before = std::make_unique<BlobContent>();
  std::memset(static_cast<void*>(model.get()), 0x5A, sizeof(BlobContent));
  std::memset(static_cast<void*>(before.get()), 0x5A, sizeof(BlobContent));
  if (decode(bytes, size, DecodeOptions{}, *model) != Status::ok) {
    if (std::memcmp(model.get(), before.get(), sizeof(BlobContent)) != 0) stop("untouched when refused");
    return;
  }
  if (const char* broken = broken_invariant(bytes, *model, true)) stop(broken);
}

// `use` on the bytes, and in half of the inputs on a blob of them with its CRC repaired. Which half hangs on the bytes, so
// that an input always does the same.
template <class Use>
void with_repaired(const std::uint8_t* data, std::size_t size, Use use) {
  use(data, size);
  if ((crc32(data, size) & 1U) != 0U) return;
  const auto bytes = std::make_unique<std::uint8_t[]>(blob_size);
  std::copy_n(data, std::min(size, blob_size), bytes.get());
  const std::uint32_t crc = crc32(bytes.get(), blob_layout::crc);
  for (std::size_t k = 0; k < 4; ++k) bytes[blob_layout::crc + k] = static_cast<std::uint8_t>(crc >> (8 * k));
  use(bytes.get(), blob_size);
}

template <class CModel, class CPose, class Real, class Load, class Count, class Forward>
void load_once(Load load, Count count, Forward forward, const std::uint8_t* bytes, std::size_t size) {
  const auto model = std::make_unique<CModel>();
  const auto before = std::make_unique<CModel>();
  std::memset(model.get(), 0x5A, sizeof(CModel));
  std::memset(before.get(), 0x5A, sizeof(CModel));
  const auto decoded = std::make_unique<BlobContent>();
  const auto expected = static_cast<std::int32_t>(decode(bytes, size, DecodeOptions{}, *decoded));
  const std::int32_t status = load(model.get(), sizeof(CModel), MDHCAL_ABI_VERSION, bytes, size, nullptr);
  if (expected != MDHCAL_OK && status != expected) stop("the C loader refuses as decode() does");
  if (status != MDHCAL_OK && status != MDHCAL_SELF_TEST_TOLERANCE) {
    const bool untouched = std::memcmp(model.get(), before.get(), sizeof(CModel)) == 0;
    // A table of joint functions is made in its place before the self-test: what fails that is no arm any more.
    if (!untouched && status != MDHCAL_SELF_TEST_FAILED) stop("a C model is untouched when refused");
    if (count(model.get()) != 0) stop("a C model that was refused is no arm");
    return;
  }
  if (count(model.get()) != decoded->geometry.joint_count) stop("a C model has the blob's joints");
  const Real q[max_joints] = {};
  CPose pose{};
  for (const std::int32_t which : {MDHCAL_NOMINAL, MDHCAL_CORRECTED}) {
    if (forward(model.get(), which, q, &pose, nullptr) != MDHCAL_OK ||
        !std::all_of(pose.position_m, pose.position_m + 3, [](Real p) { return std::isfinite(p); })) {
      stop("a C model gives finite poses");
    }
  }
}

bool same_bits(const Geometry& a, const Geometry& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

void blob_target(const std::uint8_t* data, std::size_t size) { with_repaired(data, size, decode_once); }

void loader_target(const std::uint8_t* data, std::size_t size) {
  if (data == nullptr) return;  // a null pointer is bad input in C, whatever its size
  with_repaired(data, size, [](const std::uint8_t* bytes, std::size_t count) {
    load_once<mdhcal_calibrated_arm, mdhcal_pose, double>(mdhcal_load, mdhcal_joint_count, mdhcal_forward, bytes, count);
    load_once<mdhcalf_calibrated_arm, mdhcalf_pose, float>(mdhcalf_load, mdhcalf_joint_count, mdhcalf_forward, bytes, count);
  });
}

void robot_target(const std::uint8_t* data, std::size_t size) {
  offline::Robot robot;
  try {
    robot = offline::parse_robot(std::string(data, data + size), "fuzz.toml");
  } catch (const InputError&) {
    return;
  }
  if (check_geometry(robot.geometry) != Status::ok) stop("a robot that was read is valid");
  const offline::Robot again = offline::parse_robot(offline::write_robot(robot), "again.toml");
  if (!same_bits(robot.geometry, again.geometry)) stop("a robot that was written reads back");
  try {
    (void)offline::make_blob(robot, offline::Provenance{});
  } catch (const InputError&) {
    return;
  } catch (const Refusal&) {
    return;
  }
}

void dataset_target(const std::uint8_t* data, std::size_t size) {
  static const offline::Robot robot = [] {
    offline::Robot six;
    six.geometry.joint_count = 6;
    for (std::size_t i = 0; i < 6; ++i) six.geometry.joint[i].sign = 1;
    six.geometry.last_T_flange.quaternion[0] = 1.0;
    return six;
  }();
  try {
    const offline::Dataset set = offline::parse_dataset(std::string(data, data + size), "fuzz.csv", robot);
    for (const offline::Measurement& row : set.rows) {
      if (row.group >= set.groups.size() || row.target >= set.targets.size()) stop("indices of a data set are in range");
      if (!std::all_of(row.q.begin(), row.q.end(), [](double q) { return std::isfinite(q); }) ||
          !std::all_of(row.position_m.begin(), row.position_m.end(), [](double p) { return std::isfinite(p); })) {
        stop("figures of a data set are finite");
      }
    }
  } catch (const InputError&) {
    return;
  }
}

namespace {

// The bytes as a file: some readers take a path only.
std::string as_file(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("fuzz", MFD_CLOEXEC);
  if (file < 0 || ftruncate(file, 0) != 0) stop("the fuzzer's own file");
  for (std::size_t done = 0; done < size;) {
    const ssize_t count = pwrite(file, data + done, size - done, static_cast<off_t>(done));
    if (count <= 0) stop("the fuzzer's own file");
    done += static_cast<std::size_t>(count);
  }
  return "/proc/self/fd/" + std::to_string(file);
}

const Geometry& six_joints() {
  static const Geometry geometry = [] {
    Geometry six{};
    six.joint_count = 6;
    for (std::size_t i = 0; i < 6; ++i) six.joint[i].sign = 1;
    six.last_T_flange.quaternion[0] = 1.0;
    return six;
  }();
  return geometry;
}

void require_valid(const offline::Robot& robot) {
  if (check_geometry(robot.geometry) != Status::ok) stop("a robot that was read is valid");
}

// Bad input is refused by InputError, and what a form cannot express by Refusal; anything else is a finding.
template <class Use>
void refused_or(Use use) {
  try {
    use();
  } catch (const InputError&) {
    return;
  } catch (const Refusal&) {
    return;
  }
}

}  // namespace

void urdf_target(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  offline::Robot robot;
  try {
    robot = offline::robot_from_chain(offline::parse_urdf(text, "fuzz.urdf", "", ""), "fuzz.urdf");
  } catch (const InputError&) {
    return;
  }
  require_valid(robot);
  (void)offline::parse_urdf(offline::urdf_text(robot), "again.urdf", "", "");
  refused_or([&] {
    const std::string corrected = offline::corrected_urdf(text, "fuzz.urdf", robot, "", "");
    try {
      (void)offline::parse_urdf(corrected, "corrected.urdf", "", "");
    } catch (const InputError&) {
      stop("a corrected URDF reads back");
    }
  });
}

void kinematics_target(const std::uint8_t* data, std::size_t size) {
  refused_or([&] {
    require_valid(offline::robot_from_chain(offline::parse_ros_kinematics(std::string(data, data + size), "fuzz.yaml"), "fuzz.yaml"));
  });
}

void ur_calibration_target(const std::uint8_t* data, std::size_t size) {
  refused_or([&] { require_valid(offline::parse_ur_calibration(std::string(data, data + size), "fuzz.conf", "ur5e")); });
}

void joints_target(const std::uint8_t* data, std::size_t size) {
  refused_or([&] {
    for (const auto& row : offline::read_joint_file(as_file(data, size), six_joints()).rows) {
      if (!std::all_of(row.q.begin(), row.q.end(), [](double q) { return std::isfinite(q); })) stop("readings are finite");
    }
  });
}

void poses_target(const std::uint8_t* data, std::size_t size) {
  refused_or([&] {
    for (const auto& row : offline::read_pose_file(as_file(data, size), six_joints()).rows) {
      double norm2 = 0;
      for (const double part : row.pose.quaternion) norm2 += part * part;
      if (!(std::abs(norm2 - 1) < 1e-9)) stop("rotations are unit quaternions");
      for (const double part : row.pose.position_m) {
        if (!std::isfinite(part)) stop("positions are finite");
      }
    }
  });
}

void manifest_target(const std::uint8_t* data, std::size_t size) {
  refused_or([&] {
    std::set<std::string> names;
    for (const auto& entry : offline::read_manifest(as_file(data, size))) {
      if (entry.name.empty() || entry.name[0] == '.' || entry.name.find('/') != std::string::npos) stop("a name is one folder's own");
      if (!names.insert(entry.name).second) stop("each name is there once");
    }
  });
}

void key_target(const std::uint8_t* data, std::size_t size) {
  const std::string path = as_file(data, size);
  refused_or([&] {
    const auto key = offline::read_public_key(path);
    if (offline::read_secret_key(path).seed != key) stop("a key is read in one way");
    const std::string text = offline::key_text(key);
    if (offline::read_public_key(as_file(reinterpret_cast<const std::uint8_t*>(text.data()), text.size())) != key) {
      stop("a key that was written reads back");
    }
  });
}

}  // namespace mdhcal::fuzz
