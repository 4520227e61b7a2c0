// SPDX-License-Identifier: MIT
#include "offline/measure/rotations.hpp"

#include <algorithm>
#include <cmath>

#include "offline/base/error.hpp"
#include "offline/robot/rotation.hpp"

namespace mdhcal::offline {

namespace {

using Quaternion = std::array<double, 4>;
using Matrix = std::array<std::array<double, 3>, 3>;

constexpr std::string_view inverse_ending = "-inverse";
constexpr std::string_view extrinsic_ending = "-extrinsic";
constexpr std::array<std::string_view, 12> orders{"xyz", "xzy", "yxz", "yzx", "zxy", "zyx",
                                                  "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};

// The words of controllers and of common files, each with the general name that it stands for. From the makers' manuals:
// KUKA A, B, C turn about z, y', x''; FANUC W, P, R and Yaskawa Rx, Ry, Rz about the fixed x, y, z; Staubli rx, ry, rz about
// x, y', z''; ABB's Euler angles EZ, EY, EX about z, y', x''; Comau's and Kawasaki's are z, y', z''; Mitsubishi A, B, C
// about the fixed x, y, z; Epson U, V, W about z, y', x''; Universal Robots state a rotation vector in radians.
struct Word {
  std::string_view word, general;
};
constexpr Word words[] = {{"rpy", "xyz-extrinsic"},    {"kuka", "zyx"},     {"fanuc", "xyz-extrinsic"},
                          {"staubli", "xyz"},          {"abb", "zyx"},      {"yaskawa", "xyz-extrinsic"},
                          {"ur", "vector"},            {"comau", "zyz"},    {"kawasaki", "zyz"},
                          {"mitsubishi", "xyz-extrinsic"}, {"epson", "zyx"}};

std::optional<RotationConvention> general_convention(std::string_view name) {
  RotationConvention convention;
  convention.name = name;
  if (name == "vector") return convention;
  convention.form = RotationForm::quaternion;
  convention.scalar_last = name == "quaternion-xyzw";
  if (name == "quaternion" || convention.scalar_last) return convention;
  convention.form = RotationForm::euler;
  convention.extrinsic = name.ends_with(extrinsic_ending);
  if (convention.extrinsic) name.remove_suffix(extrinsic_ending.size());
  if (std::find(orders.begin(), orders.end(), name) == orders.end()) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) convention.axis[k] = name[k] - 'x';
  return convention;
}

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion turn(std::int32_t axis, double angle_rad) {
  Quaternion q{std::cos(0.5 * angle_rad), 0, 0, 0};
  q[static_cast<std::size_t>(axis) + 1] = std::sin(0.5 * angle_rad);
  return q;
}

Quaternion normalised(Quaternion q) {
  double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(norm > 0)) return {1, 0, 0, 0};
  if (q[0] < 0) norm = -norm;
  for (double& c : q) c /= norm;
  return q;
}

Matrix matrix_of(const Quaternion& q) {
  const Frame<double> frame = frame_of(Pose<double>{{q[0], q[1], q[2], q[3]}, {0, 0, 0}});
  Matrix m{};
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) m[r][c] = frame.rotation[3 * r + c];
  }
  return m;
}

// Angles of the product R_axis[0] R_axis[1] R_axis[2]. The first is read off the matrix, the others after it has been
// taken away, so that together they stay right where each alone is ill-defined.
std::array<double, 3> product_angles(const std::array<std::int32_t, 3>& axis, const Quaternion& q) {
  const auto a = static_cast<std::size_t>(axis[0]);
  const auto b = static_cast<std::size_t>(axis[1]);
  const std::size_t c = 3 - a - b;
  const double parity = b == (a + 1) % 3 ? 1.0 : -1.0;
  const bool proper = axis[0] == axis[2];
  const Matrix r = matrix_of(q);
  const double first = proper ? std::atan2(r[b][a], -parity * r[c][a]) : std::atan2(-parity * r[b][c], r[c][c]);
  const Matrix rest = matrix_of(product(turn(axis[0], -first), q));
  if (proper) {
    return {first, std::atan2(-parity * rest[c][a], rest[a][a]), std::atan2(-parity * rest[b][c], rest[b][b])};
  }
  return {first, std::atan2(parity * rest[a][c], rest[c][c]), std::atan2(parity * rest[b][a], rest[b][b])};
}

}  // namespace

const std::vector<std::string>& rotation_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Word& word : words) list.emplace_back(word.word);
    for (const char* form : {"vector", "quaternion", "quaternion-xyzw"}) list.emplace_back(form);
    for (const std::string_view order : orders) list.emplace_back(order);
    for (const std::string_view order : orders) list.push_back(std::string(order).append(extrinsic_ending));
    return list;
  }();
  return names;
}

std::optional<RotationConvention> rotation_convention(std::string_view stated) {
  std::string name(stated);
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  std::string_view core = name;
  const bool inverse = core.ends_with(inverse_ending);
  if (inverse) core.remove_suffix(inverse_ending.size());
  const auto word = std::find_if(std::begin(words), std::end(words), [&](const Word& w) { return w.word == core; });
  auto convention = general_convention(word == std::end(words) ? core : word->general);
  if (!convention) return std::nullopt;
  convention->radians = core == "ur";
  convention->inverse = inverse;
  convention->name = name;
  return convention;
}

RotationConvention require_rotation_convention(std::string_view name, const std::string& option) {
  if (const auto convention = rotation_convention(name)) return *convention;
  std::string known;
  for (const std::string& each : rotation_names()) known += (known.empty() ? "" : ", ") + each;
  throw InputError(option + " names \"" + std::string(name) + "\"; expected one of " + known +
                   ", or one of them with -inverse behind it.");
}

Quaternion quaternion_from(const RotationConvention& convention, const Quaternion& numbers) {
  Quaternion q{1, 0, 0, 0};
  switch (convention.form) {
    case RotationForm::euler:
      for (std::size_t k = 0; k < 3; ++k) {
        const Quaternion each = turn(convention.axis[k], numbers[k]);
        q = convention.extrinsic ? product(each, q) : product(q, each);
      }
      break;
    case RotationForm::vector: q = quaternion_of({numbers[0], numbers[1], numbers[2]}); break;
    case RotationForm::quaternion:
      q = convention.scalar_last ? Quaternion{numbers[3], numbers[0], numbers[1], numbers[2]} : numbers;
      break;
  }
  if (convention.inverse) {
    for (std::size_t k = 1; k < 4; ++k) q[k] = -q[k];
  }
  return normalised(q);
}

Quaternion numbers_of(const RotationConvention& convention, const Quaternion& quaternion) {
  Quaternion q = normalised(quaternion);
  if (convention.inverse) {
    for (std::size_t k = 1; k < 4; ++k) q[k] = -q[k];
  }
  if (convention.form == RotationForm::quaternion) {
    return convention.scalar_last ? Quaternion{q[1], q[2], q[3], q[0]} : q;
  }
  if (convention.form == RotationForm::vector) {
    const auto v = rotation_vector_of(q);
    return {v[0], v[1], v[2], 0};
  }
  std::array<std::int32_t, 3> axis = convention.axis;
  if (convention.extrinsic) std::swap(axis[0], axis[2]);
  const std::array<double, 3> angles = product_angles(axis, q);
  if (convention.extrinsic) return {angles[2], angles[1], angles[0], 0};
  return {angles[0], angles[1], angles[2], 0};
}

Quaternion ordered(const RotationConvention& convention, bool by_axis, const Quaternion& numbers) {
  if (!by_axis || convention.form != RotationForm::euler || !convention.names_axes()) return numbers;
  Quaternion out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = numbers[static_cast<std::size_t>(convention.axis[k])];
  return out;
}

}  // namespace mdhcal::offline
