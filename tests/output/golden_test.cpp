// SPDX-License-Identifier: MIT
// The golden blobs, made byte by byte from docs/blob.md by a script, against the library, the writer and a reader in
// another language. They were made for format 2.0 by golden_blob.py in tests/output on 2026-11-29: they must load as long as the format is 2.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <regex>

#include "mdhcal/crc32.hpp"
#include "offline/output/blob_writer.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::offline {
namespace {

using nlohmann::json;
using tests::read_bytes;

const std::string source = MDHCAL_SOURCE_DIR;

std::string golden_path(const std::string& name) { return source + "/tests/blob/golden/" + name + "-2.0.blob"; }

const std::uint8_t* bytes_of(const std::string& text) { return reinterpret_cast<const std::uint8_t*>(text.data()); }

class Golden : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Blob, Golden, testing::Values("every-field", "six-joints"),
                         [](const auto& golden) { return std::string(golden.param, 3); });

TEST_P(Golden, IsWhatTheScriptMakes) {
  const tests::TemporaryFolder folder;
  const auto run = tests::run_program("python3", {source + "/tests/output/golden_blob.py", GetParam(), folder / "made.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_bytes(folder / "made.blob"), read_bytes(golden_path(GetParam())));
}

TEST_P(Golden, LoadsAndEncodesBack) {
  const std::string bytes = read_bytes(golden_path(GetParam()));
  BlobContent model{};
  ASSERT_EQ(decode(bytes_of(bytes), bytes.size(), DecodeOptions{}, model), Status::ok);
  const Blob again = encode(model);
  EXPECT_EQ(std::memcmp(again.data(), bytes.data(), bytes.size()), 0);
}

template <class Real>
json vector_json(const SelfTestVector<Real>& vector) {
  json pose(vector.base_T_flange.quaternion);
  for (const Real p : vector.base_T_flange.position_m) pose.push_back(p);
  return {{"q", vector.q}, {"pose", pose}, {"inverse_q", vector.inverse_q}, {"inverse_status", vector.inverse_status}};
}

json link_json(const Link& link) { return {link.alpha_rad, link.a_m, link.theta_rad, link.d_m, link.beta_rad}; }

json pose_json(const Pose<double>& pose) { return {{"quaternion", pose.quaternion}, {"position", pose.position_m}}; }

std::string hexadecimal(const std::uint8_t* bytes, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) {
    text += "0123456789abcdef"[bytes[i] >> 4];
    text += "0123456789abcdef"[bytes[i] & 15];
  }
  return text;
}

// The decoder's view under the names of docs/blob.md.
json as_json(const BlobContent& m) {
  json joints;
  json targets;
  json functions;
  json compliance;
  json doubles;
  json floats;
  for (std::size_t i = 0; i < 8; ++i) {
    const Joint& joint = m.geometry.joint[i];
    joints.push_back({{"kind", static_cast<int>(joint.kind)},
                      {"sign", joint.sign},
                      {"flags", joint.has_min + 2 * joint.has_max},
                      {"min", joint.min},
                      {"max", joint.max},
                      {"nominal", link_json(m.nominal[i])},
                      {"corrected", link_json(m.geometry.link[i])},
                      {"coupling", joint.coupling},
                      {"max_velocity", m.max_velocity[i]}});
    const JointFunction& f = m.transmission.function[i];
    functions.push_back({{"order_count", f.order_count},
                         {"seen_min", f.seen_min_rad},
                         {"seen_max", f.seen_max_rad},
                         {"cosine", f.cosine_rad},
                         {"sine", f.sine_rad}});
    for (const double k : m.transmission.gravity.compliance[i]) compliance.push_back(k);
    targets.push_back({{"name", m.target[i].name}, {"point", m.target[i].flange_p_m}});
  }
  for (std::size_t i = 0; i < 4; ++i) {
    doubles.push_back(vector_json(m.double_vector[i]));
    floats.push_back(vector_json(m.float_vector[i]));
  }
  const BlobProvenance& p = m.provenance;
  const Gravity& gravity = m.transmission.gravity;
  Pose<double> base = m.tracker_T_base;
  if (m.has_base == 0) base = Pose<double>{};  // identity in the model, zero in the bytes
  return {{"major", 2},
          {"minor", 0},
          {"flags", m.has_base + 2 * p.has_measurements + 4 * p.has_lambda + 8 * p.has_held_out + 16 * p.has_region},
          {"joint_count", m.geometry.joint_count},
          {"target_count", m.target_count},
          {"family", static_cast<int>(m.family)},
          {"security_counter", m.security_counter},
          {"arithmetic_id", m.arithmetic_id},
          {"double_vector_count", m.double_vector_count},
          {"float_vector_count", m.float_vector_count},
          {"name", m.name},
          {"serial", m.serial},
          {"joints", joints},
          {"last_T_flange", pose_json(m.geometry.last_T_flange)},
          {"tracker_T_base", pose_json(base)},
          {"targets", targets},
          {"tolerances",
           {m.tolerances.position_m, m.tolerances.rotation_rad, m.tolerances.float_position_m,
            m.tolerances.float_rotation_rad}},
          {"tool_version", p.tool_version},
          {"date", p.date},
          {"method", p.method},
          {"measurements_sha256", hexadecimal(p.measurements_sha256, 32)},
          {"lambda_rule", p.lambda_rule},
          {"lambda", p.lambda},
          {"pose_count", p.pose_count},
          {"held_out_count", p.held_out_count},
          {"held_out", {p.mean_before_m, p.max_before_m, p.mean_after_m, p.max_after_m}},
          {"double_vectors", doubles},
          {"float_vectors", floats},
          {"functions", functions},
          {"gravity", gravity.direction},
          {"payload", gravity.payload_kg},
          {"payload_com", gravity.payload_com_m},
          {"payload_compliance", gravity.payload_compliance},
          {"compliance", compliance},
          {"region_min", p.region_min_m},
          {"region_max", p.region_max_m},
          {"lean", {p.lean_min_m, p.lean_max_m}},
          {"algorithm", m.authentication.algorithm},
          {"key_id", hexadecimal(m.authentication.key_id, 8)},
          {"signature", hexadecimal(m.authentication.signature, 64)}};
}

TEST_P(Golden, IsReadAlikeInAnotherLanguage) {
  const auto run = tests::run_program("python3", {source + "/tests/output/read_blob.py", golden_path(GetParam())});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string bytes = read_bytes(golden_path(GetParam()));
  BlobContent model{};
  ASSERT_EQ(decode(bytes_of(bytes), bytes.size(), DecodeOptions{}, model), Status::ok);
  const json theirs = json::parse(run.out);
  const json ours = as_json(model);
  EXPECT_EQ(theirs, ours) << json::diff(theirs, ours).dump(1);
}

TEST(BlobPage, ReaderInAnotherLanguageReadsTheWritersBlob) {
  const tests::TemporaryFolder folder;
  Robot robot;
  robot.name = "writer";
  robot.geometry.joint_count = 1;
  robot.geometry.joint[0].sign = 1;
  robot.geometry.link[0].a_m = robot.nominal[0].a_m = 0.123;
  robot.geometry.last_T_flange.quaternion[0] = 1.0;
  const Blob blob = make_blob(robot, Provenance{});
  tests::write_bytes(folder / "one.blob", std::string(reinterpret_cast<const char*>(blob.data()), blob.size()));
  const auto run = tests::run_program("python3", {source + "/tests/output/read_blob.py", folder / "one.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json theirs = json::parse(run.out);
  EXPECT_EQ(theirs["name"], "writer");
  EXPECT_EQ(theirs["joints"][0]["corrected"][1], 0.123);
}

struct Row {
  std::string offset, field, type;
};

// The rows of the field tables of docs/blob.md.
std::vector<Row> field_list() {
  const std::string page = read_bytes(source + "/docs/blob.md");
  const std::size_t from = page.find("## Every byte");
  const std::string tables = page.substr(from, page.find("### Layout id") - from);
  const std::regex row(R"(\n\| (\d+) \| ([\w.]+) \| ([\w\[\]]+) \|)");
  std::vector<Row> rows;
  for (std::sregex_iterator at(tables.begin(), tables.end(), row), end; at != end; ++at) {
    rows.push_back({(*at)[1], (*at)[2], (*at)[3]});
  }
  return rows;
}

TEST(BlobPage, LayoutIdIsTheCrcOfTheFieldList) {
  std::string list;
  for (const Row& row : field_list()) list += row.offset + ' ' + row.field + ' ' + row.type + '\n';
  EXPECT_EQ(crc32(bytes_of(list), list.size()), blob_layout::layout_id_value);
}

TEST(BlobPage, FieldListLeavesNoByteOut) {
  std::map<std::string, std::size_t> size{{"u16", 2},    {"u32", 4},     {"i32", 4},            {"f64", 8},
                                          {"f32", 4},    {"bytes", 1},   {"text", 1},           {"joint", 192},
                                          {"pose", 64},  {"target", 40}, {"double_vector", 192}, {"float_vector", 96},
                                          {"function", 352}};
  std::map<std::string, std::size_t> end;  // by record; "" is the blob
  for (const Row& row : field_list()) {
    const std::size_t dot = row.field.find('.');
    const std::string record = dot == std::string::npos ? "" : row.field.substr(0, dot);
    EXPECT_EQ(std::stoul(row.offset), end[record]) << row.field;
    const std::size_t bracket = row.type.find('[');
    const std::size_t count = bracket == std::string::npos ? 1 : std::stoul(row.type.substr(bracket + 1));
    ASSERT_TRUE(size.contains(row.type.substr(0, bracket))) << row.type;
    end[record] += count * size[row.type.substr(0, bracket)];
  }
  EXPECT_EQ(end[""], blob_size);
  for (const auto& [record, bytes] : end) {
    if (!record.empty()) {
      EXPECT_EQ(bytes, size[record]) << record;
    }
  }
}

}  // namespace
}  // namespace mdhcal::offline
