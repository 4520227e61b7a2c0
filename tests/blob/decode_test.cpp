// SPDX-License-Identifier: MIT
// Undamaged bytes: what is read, what is refused although the CRC holds, and the caller's demands.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "mdhcal/arm.hpp"
#include "mdhcal/kinematics.hpp"
#include "tests/blob/support.hpp"

namespace mdhcal::test {
namespace {

namespace at = blob_layout;

TEST(Decode, ReadsTheGoldenBlobAtAnyAlignment) {
  alignas(8) std::uint8_t room[blob_size + 8];
  for (std::size_t shift = 0; shift < 8; ++shift) {
    std::memcpy(room + shift, golden::every_field, blob_size);
    const auto model = std::make_unique<BlobContent>();
    ASSERT_EQ(decode(room + shift, blob_size, {}, *model), Status::ok);
    EXPECT_STREQ(model->serial, "SN/2026-0815");
    EXPECT_EQ(model->geometry.joint_count, 8);
    EXPECT_EQ(model->geometry.link[7].a_m, 0.2 + 0.01 * 7 + 1e-4 * 8 * (1 - 2.5));
    EXPECT_EQ(model->float_vector[3].inverse_status, 2);
  }
}

// Nothing in a blob is idle: with the CRC repaired, a changed byte is refused or changes the model.
TEST(Decode, NoByteIsIgnored) {
  Bytes bytes = copy_of(golden::every_field);
  const auto zeroed = [] {
    auto model = std::make_unique<BlobContent>();
    std::memset(static_cast<void*>(model.get()), 0, sizeof(BlobContent));
    return model;
  };
  const auto original = zeroed();
  ASSERT_EQ(decode(bytes.data(), bytes.size(), {}, *original), Status::ok);
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < at::crc; ++i) {
    if (i == at::minor || i == at::minor + 1) continue;  // newer minor versions: below
    for (const unsigned mask : {1U, 0x80U, 0xFFU}) {
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ mask);
      repair_crc(bytes);
      const auto model = zeroed();
      if (decode(bytes.data(), bytes.size(), {}, *model) == Status::ok) {
        ++accepted;
        EXPECT_NE(std::memcmp(model.get(), original.get(), sizeof(BlobContent)), 0) << "byte " << i;
      }
      bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ mask);
    }
  }
  EXPECT_GT(accepted, 2000U) << "most low bits of mantissas are acceptable values";
}

TEST(Decode, RefusesOtherVersions) {
  Bytes bytes = copy_of(golden::every_field);
  put(bytes, at::major, 1, 2);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_version);
  put(bytes, at::major, 3, 2);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_version);
  put(bytes, at::major, 0, 2);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_version);
}

constexpr std::size_t ancillary[] = {at::header_reserved, at::header_reserved + 15, at::tolerances_reserved, at::provenance_reserved,
                                     at::provenance_reserved + 15, at::double_vectors + at::double_vector_reserved,
                                     at::algorithm_reserved + 3, at::key_reserved, at::end_reserved,
                                     at::end_reserved + 27};
constexpr std::size_t critical[] = {at::model_room, at::model_room + at::model_room_size - 1,
                                    at::joints + at::joint::reserved, at::joints + at::joint::reserved_end + 7,
                                    at::functions + at::function::reserved, at::functions + at::function::reserved_middle + 7,
                                    at::gravity_reserved, at::gravity_reserved + 7,
                                    at::last_T_flange + at::pose_reserved, at::tracker_T_base + at::pose_reserved + 7};

TEST(Decode, ReservedBytesFollowTheVersionRules) {
  for (const std::uint64_t minor : {0U, 1U, 0xFFFFU}) {
    Bytes bytes = copy_of(golden::every_field);
    put(bytes, at::minor, minor, 2);
    EXPECT_EQ(decode_repaired(bytes), Status::ok) << minor;
    for (const std::size_t offset : ancillary) {
      bytes[offset] = 1;
      EXPECT_EQ(decode_repaired(bytes), minor == 0 ? Status::blob_reserved : Status::ok) << offset;
      bytes[offset] = 0;
    }
    for (const std::size_t offset : critical) {
      bytes[offset] = 1;
      EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved) << offset;
      bytes[offset] = 0;
    }
    put(bytes, at::flags, 0x3F, 4);
    EXPECT_EQ(decode_repaired(bytes), minor == 0 ? Status::blob_reserved : Status::ok);
    put(bytes, at::flags, 0x1001F, 4);
    EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved);
  }
}

TEST(Decode, WhatIsAbsentIsZero) {
  const std::uint64_t joint0 = at::joints;
  Bytes bytes = copy_of(golden::every_field);
  for (const std::uint64_t flag : {at::flag_base, at::flag_calibrated, at::flag_lambda, at::flag_held_out, at::flag_region}) {
    put(bytes, at::flags, 0x1F & ~flag, 4);
    EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved) << flag;
  }
  put(bytes, at::flags, 0x1F, 4);
  for (const std::size_t count : {at::joint_count, at::target_count, at::double_vector_count, at::float_vector_count}) {
    const std::uint8_t whole = bytes[count];
    bytes[count] = static_cast<std::uint8_t>(whole - 1);
    EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved) << count;
    bytes[count] = static_cast<std::uint8_t>(whole + 1);
    EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << count;
    bytes[count] = whole;
  }
  put(bytes, joint0 + at::joint::flags, at::joint_has_max, 4);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved);
  put(bytes, joint0 + at::joint::flags, 7, 4);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved);
  put(bytes, joint0 + at::joint::flags, 3, 4);
  put(bytes, at::algorithm, 0, 4);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_reserved);
}

// Amplitudes add up to 5 mrad at most, and times their orders to 0.1.
TEST(Decode, BoundsTheJointFunctions) {
  Bytes bytes = copy_of(golden::every_field);
  const std::size_t f = at::functions + at::function::cosine;
  put(bytes, f, 0.0039F);
  EXPECT_EQ(decode_repaired(bytes), Status::ok);
  put(bytes, f, 0.0051F);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_deviation);
  bytes = copy_of(golden::every_field);
  put(bytes, f + 4 * 39, 0.0020F);
  EXPECT_EQ(decode_repaired(bytes), Status::ok);
  put(bytes, f + 4 * 39, 0.0025F);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_deviation);
  put(bytes, at::functions, std::uint64_t{41}, 4);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_value);
  put(bytes, at::functions, std::uint64_t{39}, 4);
  EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << "an order beyond the count";
}

struct Case {
  std::size_t offset;
  double value;
  Status status;
};

TEST(Decode, RefusesValuesOutOfRange) {
  constexpr std::size_t j = at::joints;
  constexpr std::size_t f = at::functions;
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  const Case cases[] = {
      {j + at::joint::min, 2.6, Status::blob_value},                 // above max
      {j + at::joint::min, -1000.5, Status::blob_value},             // beyond any reading
      {j + at::joint::corrected + 8, 0.2 + 0.0501, Status::blob_deviation},
      {j + at::joint::corrected + 8, 0.2 + 0.0499, Status::ok},
      {j + at::joint::corrected, -0.35 - 0.0501, Status::blob_deviation},
      {j + at::joint::corrected, -0.35 - 0.0499, Status::ok},
      {j + at::joint::corrected + 32, -0.0501, Status::blob_deviation},
      {j + at::joint::corrected + 24, 1000.5, Status::blob_value},
      {j + at::joint::corrected, 13.0, Status::blob_value},
      {j + at::joint::nominal + 8, -1000.5, Status::blob_value},
      {j + at::joint::coupling, tiny, Status::blob_value},           // on itself
      {j + at::joint::coupling + 8, 100.5, Status::blob_value},
      {at::last_T_flange, 0.6, Status::blob_value},                  // not a unit quaternion
      {at::tracker_T_base, -0.8, Status::blob_value},                // w < 0
      {at::tracker_T_base + 32, 1000.5, Status::blob_value},
      {at::targets + at::target_point, -1000.5, Status::blob_value},
      {at::tolerances, 0.0, Status::blob_value},
      {at::tolerances + 8, -1e-9, Status::blob_value},
      {at::lambda, -tiny, Status::blob_value},
      {at::lambda, 1e31, Status::blob_value},
      {at::held_out, -1e-9, Status::blob_value},
      {at::held_out + 24, 1001.0, Status::blob_value},
      {j + at::joint::max_velocity, -0.5, Status::blob_value},
      {j + at::joint::max_velocity, 1000.5, Status::blob_value},
      {f + at::function::seen_min, 1.8, Status::blob_value},         // above seen_max
      {f + at::function::seen_max, 1000.5, Status::blob_value},
      {f + at::function::seen_max, -1.45, Status::blob_value},       // not a sector long
      {at::gravity, 0.7, Status::blob_value},                        // not of length 1
      {at::payload, -0.5, Status::blob_value},
      {at::payload, 10001.0, Status::blob_value},
      {at::payload_com, 1000.5, Status::blob_value},
      {at::payload_compliance + 16, 1e-9, Status::blob_value},       // of a joint that slides
      {at::compliance + 8 * 8, 1e-9, Status::blob_value},            // of joint 2 for link 1
      {at::compliance, 0.1, Status::blob_deviation},
      {at::region, 1.75, Status::blob_value},                        // above its maximum
      {at::region + 48, -0.1, Status::blob_value},
      {at::region + 56, 1000.5, Status::blob_value},
      {at::double_vectors, 1000.5, Status::blob_value},
      {at::double_vectors + 64, 0.5, Status::blob_value},
      {at::double_vectors + 96, 2e7, Status::blob_value},
      {at::double_vectors + 120, -1000.5, Status::blob_value},
  };
  for (const Case& c : cases) {
    Bytes bytes = copy_of(golden::every_field);
    put(bytes, c.offset, c.value);
    EXPECT_EQ(decode_repaired(bytes), c.status) << "offset " << c.offset << " value " << c.value;
  }
  for (const float tolerance : {0.0F, -1e-6F, 1.5F, std::numeric_limits<float>::quiet_NaN()}) {
    for (const std::size_t offset : {at::float_tolerances, at::float_tolerances + 4}) {
      Bytes bytes = copy_of(golden::every_field);
      put(bytes, offset, tolerance);
      EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << tolerance;
    }
  }
}

TEST(Decode, RefusesUnknownEnumerations) {
  const std::size_t fields[] = {at::family, at::algorithm, at::joints + at::joint::kind, at::joints + at::joint::sign,
                                at::double_vectors + 184, at::float_vectors + 92};
  for (const std::size_t field : fields) {
    for (const std::uint64_t value : {6ULL, 0x7FFFFFFFULL, 0x80000000ULL, 0xFFFFFFFEULL}) {
      Bytes bytes = copy_of(golden::every_field);
      put(bytes, field, value, 4);
      EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << field << ' ' << value;
    }
  }
}

// Every 8 bytes that hold a binary64, and every 4 that hold a binary32.
TEST(Decode, RefusesWhatIsNotFinite) {
  const auto refuse = [](std::size_t offset, auto value) {
    Bytes bytes = copy_of(golden::every_field);
    put(bytes, offset, value);
    EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << "offset " << offset;
  };
  using D = std::numeric_limits<double>;
  using F = std::numeric_limits<float>;
  const auto doubles = [&](std::size_t from, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      for (const double value : {D::quiet_NaN(), -D::infinity(), D::infinity()}) refuse(from + 8 * i, value);
    }
  };
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t joint = at::joints + i * at::joint_size;
    if (i % 4 < 2) doubles(joint + at::joint::min, 1);
    if (i % 2 == 0) doubles(joint + at::joint::max, 1);
    doubles(joint + at::joint::nominal, 19);
    doubles(at::functions + i * at::function_size + at::function::seen_min, 2);
    doubles(at::targets + i * at::target_size + at::target_point, 3);
  }
  doubles(at::last_T_flange, 7);
  doubles(at::tracker_T_base, 7);
  doubles(at::tolerances, 2);
  doubles(at::lambda, 1);
  doubles(at::held_out, 4);
  doubles(at::gravity, 7);
  doubles(at::payload_compliance, 8);
  doubles(at::compliance, 64);
  doubles(at::region, 8);
  for (std::size_t k = 0; k < 40; ++k) {
    for (const float value : {F::quiet_NaN(), -F::infinity(), F::infinity(), 1.5F}) {
      refuse(at::functions + at::function::cosine + 4 * k, value);
      refuse(at::functions + at::function::sine + 4 * k, value);
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    doubles(at::double_vectors + i * at::double_vector_size, 23);
    for (std::size_t k = 0; k < 23; ++k) {
      for (const float value : {F::quiet_NaN(), -F::infinity(), F::infinity()}) {
        refuse(at::float_vectors + i * at::float_vector_size + 4 * k, value);
      }
    }
  }
}

TEST(Decode, RefusesMalformedText) {
  const std::size_t fields[][2] = {{at::name, at::name_size},           {at::serial, at::serial_size},
                                   {at::tool_version, at::tool_version_size}, {at::date, at::date_size},
                                   {at::method, at::method_size},       {at::lambda_rule, at::lambda_rule_size},
                                   {at::targets, at::target_name_size}};
  for (const auto& [offset, size] : fields) {
    Bytes bytes = copy_of(golden::every_field);
    for (std::size_t i = 0; i < size; ++i) bytes[offset + i] = 'x';
    EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << "unterminated at " << offset;
    bytes[offset + size - 1] = 0;
    EXPECT_EQ(decode_repaired(bytes), Status::ok);
    bytes[offset + size - 3] = 0;
    EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << "bytes behind the end at " << offset;
    bytes[offset + size - 2] = 0;
    EXPECT_EQ(decode_repaired(bytes), Status::ok);
    bytes[offset] = '\n';
    EXPECT_EQ(decode_repaired(bytes), Status::blob_value) << "control character at " << offset;
  }
}

// Well-formed UTF-8 (RFC 3629), as docs/blob.md says; every other byte sequence is refused in every text.
TEST(Decode, RefusesTextThatIsNoUtf8) {
  const char* const good[] = {"caf\xC3\xA9", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xEE\x80\x80",
                              "\xEF\xBF\xBF", "\xF0\x90\x80\x80", "\xF0\x9F\x98\x80", "\xF4\x8F\xBF\xBF"};
  const char* const bad[] = {"caf\xE9",      "\x80",         "\xBF",     "\xC0\x80",         "\xC1\xBF", "\xC3",     "\xC3x",
                             "\xE0\x9F\xBF", "\xED\xA0\x80", "\xE2\x82", "\xF0\x8F\xBF\xBF", "\xF0\x9F\x98",
                             "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF", "\xF0\x9F\x98x"};
  const std::size_t fields[][2] = {{at::name, at::name_size}, {at::serial, at::serial_size}, {at::method, at::method_size},
                                   {at::targets, at::target_name_size}};
  for (const auto& [offset, size] : fields) {
    const auto decoded = [&](const char* text, std::size_t from) {
      Bytes bytes = copy_of(golden::every_field);
      for (std::size_t i = 0; i < size; ++i) bytes[offset + i] = i < from ? 'x' : 0;
      for (std::size_t i = 0; text[i] != 0; ++i) bytes[offset + from + i] = static_cast<std::uint8_t>(text[i]);
      return decode_repaired(bytes);
    };
    for (const char* text : good) EXPECT_EQ(decoded(text, 0), Status::ok) << text;
    for (const char* text : bad) EXPECT_EQ(decoded(text, 0), Status::blob_value) << text;
    // Up to the last byte before the zero, and over it.
    EXPECT_EQ(decoded("\xE2\x82\xAC", size - 4), Status::ok);
    EXPECT_EQ(decoded("\xE2\x82\xAC", size - 3), Status::blob_value);
    EXPECT_EQ(decoded("\xE2\x82", size - 2), Status::blob_value);
  }
}

TEST(Decode, HoldsTheCallersSerial) {
  const Bytes bytes = copy_of(golden::every_field);
  DecodeOptions options;
  for (const char* serial : {"SN/2026-081", "SN/2026-08150", "sn/2026-0815", "", "12345678901234567890123456789012345"}) {
    options.serial = serial;
    EXPECT_EQ(decode_repaired(bytes, options), Status::blob_serial) << serial;
  }
  options.serial = "SN/2026-0815";
  EXPECT_EQ(decode_repaired(bytes, options), Status::ok);
  options.serial = "";
  EXPECT_EQ(decode_repaired(copy_of(golden::six_joints), options), Status::ok);
}

struct Call {
  const std::uint8_t* blob = nullptr;
  int calls = 0;
  bool answer = true;
};

bool fake_verify(const std::uint8_t* message, std::size_t size, const std::uint8_t* signature, void* context) {
  auto* call = static_cast<Call*>(context);
  ++call->calls;
  return message == call->blob && size == 8032 && signature == call->blob + 8064 && call->answer;
}

TEST(Decode, AsksTheVerifier) {
  Bytes bytes = copy_of(golden::every_field);
  Call call{bytes.data()};
  DecodeOptions options;
  options.verifier = {fake_verify, &call};
  Watched watched;
  call.answer = false;
  EXPECT_EQ(decode(bytes.data(), bytes.size(), options, *watched.model), Status::blob_signature);
  EXPECT_TRUE(watched.untouched());
  call.answer = true;
  EXPECT_EQ(decode(bytes.data(), bytes.size(), options, *watched.model), Status::ok);
  EXPECT_EQ(call.calls, 2);
  bytes = copy_of(golden::six_joints);
  EXPECT_EQ(decode(bytes.data(), bytes.size(), options, *watched.model), Status::blob_unsigned);
  EXPECT_EQ(call.calls, 2);
}

TEST(Decode, HoldsTheMinimumCounter) {
  const Bytes bytes = copy_of(golden::every_field);
  DecodeOptions options;
  options.minimum_counter = 77;
  EXPECT_EQ(decode_repaired(bytes, options), Status::ok);
  options.minimum_counter = 78;
  EXPECT_EQ(decode_repaired(bytes, options), Status::blob_counter);
}

TEST(Decode, AcceptedArmsGiveFinitePoses) {
  const auto model = std::make_unique<BlobContent>();
  ASSERT_EQ(decode(golden::every_field, blob_size, {}, *model), Status::ok);
  Arm<double> arm{};
  ASSERT_EQ(make_arm(model->geometry, arm), Status::ok);
  Pose<double> pose{};
  const double q[8] = {1000, -1000, 1000, 1000, -1000, 1000, 0, -1000};
  ASSERT_EQ(forward(arm, q, pose), Status::ok);
  for (const double c : pose.quaternion) EXPECT_LE(c * c, 1.0 + 1e-12);
  for (const double p : pose.position_m) EXPECT_LT(p * p, 1e14);
}

}  // namespace
}  // namespace mdhcal::test
