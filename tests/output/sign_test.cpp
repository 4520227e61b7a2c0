// SPDX-License-Identifier: MIT
// Signatures: exactly the right blobs load. The host signs, the port's verifier judges.
#include "offline/output/sign.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "mdhcal/crc32.hpp"
#include "mdhcal/port/sodium_verifier.hpp"
#include "tests/output/sample_robot.hpp"
#include "tests/support/program.hpp"

namespace mdhcal::offline {
namespace {

using tests::read_bytes;
using tests::run_mdhcal;

std::vector<std::uint8_t> unhex(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

std::array<std::uint8_t, 32> key32(const std::string& text) {
  std::array<std::uint8_t, 32> key{};
  const auto bytes = unhex(text);
  std::copy(bytes.begin(), bytes.end(), key.begin());
  return key;
}

SodiumKey port_key(const KeyPair& key) {
  SodiumKey out{};
  std::copy(key.public_key.begin(), key.public_key.end(), out.public_key);
  return out;
}

// RFC 8032, section 7.1, TEST 2.
const std::string rfc_secret = "4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb";
const std::string rfc_public = "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c";
const std::string rfc_signature =
    "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d"
    "291612bb0c00";

TEST(Sign, KeysAndVerifierFollowTheRfc) {
  const KeyPair key = key_of(key32(rfc_secret));
  EXPECT_EQ(key.public_key, key32(rfc_public));
  SodiumKey verifying = port_key(key);
  const Verifier verifier = sodium_verifier(verifying);
  const std::uint8_t message[] = {0x72};
  auto signature = unhex(rfc_signature);
  EXPECT_TRUE(verifier.verify(message, 1, signature.data(), verifier.context));
  signature[10] ^= 1;
  EXPECT_FALSE(verifier.verify(message, 1, signature.data(), verifier.context));
}

class SignedBlob : public testing::Test {
 protected:
  SignedBlob() : key_(key_of(key32(rfc_secret))), verifying_(port_key(key_)), blob_(make_blob(sample_robot(), sample_provenance())) {
    sign(blob_, key_, 5);
  }

  Status load(const Blob& blob, std::uint32_t minimum_counter = 5, const char* serial = "SN-0007") {
    DecodeOptions options;
    options.serial = serial;
    options.verifier = sodium_verifier(verifying_);
    options.minimum_counter = minimum_counter;
    BlobContent model{};
    return decode(blob.data(), blob.size(), options, model);
  }

  static void repair_crc(Blob& blob) {
    const std::uint32_t crc = crc32(blob.data(), blob_layout::crc);
    for (std::size_t k = 0; k < 4; ++k) blob.at(blob_layout::crc + k) = static_cast<std::uint8_t>(crc >> (8 * k));
  }

  KeyPair key_;
  SodiumKey verifying_;
  Blob blob_;
};

TEST_F(SignedBlob, Loads) {
  EXPECT_EQ(load(blob_), Status::ok);
  EXPECT_TRUE(signature_verifies(blob_, key_.public_key));
  BlobContent model{};
  ASSERT_EQ(decode(blob_.data(), blob_.size(), DecodeOptions{}, model), Status::ok);
  EXPECT_EQ(model.security_counter, 5U);
  EXPECT_EQ(encode(model), blob_) << "encoding keeps the signature";
}

TEST_F(SignedBlob, SignedAgainIsTheSame) {
  Blob again = blob_;
  sign(again, key_, std::nullopt);
  EXPECT_EQ(again, blob_);
  sign(again, key_, 6);
  EXPECT_EQ(load(again, 6), Status::ok);
}

TEST_F(SignedBlob, SignedByAnotherIsRefused) {
  Blob other = blob_;
  sign(other, key_of(key32(std::string(64, '7'))), std::nullopt);
  EXPECT_EQ(load(other), Status::blob_signature);
  EXPECT_FALSE(signature_verifies(other, key_.public_key));
}

TEST_F(SignedBlob, StrippedIsRefused) {
  Blob stripped = blob_;
  std::fill(stripped.begin() + blob_layout::authentication, stripped.end(), std::uint8_t{0});
  repair_crc(stripped);
  EXPECT_EQ(load(stripped), Status::blob_unsigned);
  BlobContent model{};
  EXPECT_EQ(decode(stripped.data(), stripped.size(), DecodeOptions{}, model), Status::ok) << "it is whole but for that";
}

TEST_F(SignedBlob, AnyChangeUnderTheSignatureIsRefused) {
  // One bit in every granule; a changed security counter too.
  for (std::size_t at = 17; at < blob_layout::authentication; at += 32) {
    Blob changed = blob_;
    changed[at] ^= 1;
    repair_crc(changed);
    EXPECT_EQ(load(changed), Status::blob_signature) << at;
  }
  Blob promoted = blob_;
  promoted[blob_layout::security_counter] = 9;
  repair_crc(promoted);
  EXPECT_EQ(load(promoted), Status::blob_signature);
  Blob bent = blob_;
  bent[blob_layout::signature + 40] ^= 4;
  repair_crc(bent);
  EXPECT_EQ(load(bent), Status::blob_signature);
}

TEST_F(SignedBlob, TheSignatureOfAnotherBlobIsRefused) {
  Robot robot = sample_robot();
  robot.geometry.link[2].a_m += 0.001;
  Blob other = make_blob(robot, sample_provenance());
  std::copy(blob_.begin() + blob_layout::authentication, blob_.end(), other.begin() + blob_layout::authentication);
  repair_crc(other);
  EXPECT_EQ(load(other), Status::blob_signature);
}

TEST_F(SignedBlob, AnOlderCounterIsRefused) {
  EXPECT_EQ(load(blob_, 6), Status::blob_counter);
  EXPECT_EQ(load(blob_, 4), Status::ok);
}

TEST_F(SignedBlob, AnotherSerialIsRefused) {
  Robot robot = sample_robot();
  robot.serial = "SN-0008";
  Blob other = make_blob(robot, sample_provenance());
  sign(other, key_, 5);
  EXPECT_EQ(load(other), Status::blob_serial);
  EXPECT_EQ(load(other, 5, "SN-0008"), Status::ok);
}

TEST_F(SignedBlob, TruncatedIsRefused) {
  DecodeOptions options;
  options.verifier = sodium_verifier(verifying_);
  BlobContent model{};
  for (std::size_t size = 0; size < blob_.size(); ++size) {
    ASSERT_EQ(decode(blob_.data(), size, options, model), Status::blob_size);
  }
}

TEST(SignCommands, MakeAKeyAndSign) {
  const tests::TemporaryFolder folder;
  const std::string blob = std::string(MDHCAL_SOURCE_DIR) + "/tests/blob/golden/six-joints-2.0.blob";
  ASSERT_EQ(run_mdhcal({"keygen", "-o", folder / "room"}).exit_code, 0);
  struct stat status {};
  ASSERT_EQ(stat((folder / "room.key").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U) << "the secret is its owner's only";
  EXPECT_EQ(key_text(key_of(read_secret_key(folder / "room.key").seed).public_key), read_bytes(folder / "room.pub"));

  const std::string secret = read_bytes(folder / "room.key");
  EXPECT_EQ(run_mdhcal({"keygen", "-o", folder / "room"}).exit_code, 2) << "a key is never written over";
  EXPECT_EQ(read_bytes(folder / "room.key"), secret);

  const auto run = run_mdhcal({"sign", blob, "--key", folder / "room.key", "--counter", "3", "-o", folder / "signed.blob"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run_mdhcal({"show", folder / "signed.blob", "--key", folder / "room.pub"}).exit_code, 0);
  EXPECT_EQ(run_mdhcal({"show", blob, "--key", folder / "room.pub"}).exit_code, 1) << "unsigned";
  ASSERT_EQ(run_mdhcal({"keygen", "-o", folder / "other"}).exit_code, 0);
  EXPECT_EQ(run_mdhcal({"show", folder / "signed.blob", "--key", folder / "other.pub"}).exit_code, 1);

  for (const std::string& wrong : {secret.substr(1), secret + "0", std::string("no key"), std::string()}) {
    tests::write_bytes(folder / "wrong.key", wrong);
    EXPECT_EQ(run_mdhcal({"sign", blob, "--key", folder / "wrong.key", "-o", folder / "none.blob"}).exit_code, 2) << wrong;
  }
}

// What was made of a run that was stopped between the two files: the public key is there for the asking.
TEST(SignCommands, APublicKeyComesFromItsSecret) {
  const tests::TemporaryFolder folder;
  ASSERT_EQ(run_mdhcal({"keygen", "-o", folder / "room"}).exit_code, 0);
  const std::string secret = read_bytes(folder / "room.key"), open = read_bytes(folder / "room.pub");
  std::remove((folder / "room.pub").c_str());
  const auto again = run_mdhcal({"keygen", "-o", folder / "room"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_NE(again.err.find("--from"), std::string::npos) << again.err;
  EXPECT_EQ(run_mdhcal({"keygen", "--from", folder / "room.key", "-o", folder / "room"}).exit_code, 0);
  EXPECT_EQ(read_bytes(folder / "room.pub"), open);
  EXPECT_EQ(read_bytes(folder / "room.key"), secret);
  EXPECT_EQ(run_mdhcal({"keygen", "--from", folder / "room.key", "-o", folder / "room"}).exit_code, 2) << "never written over";
  EXPECT_EQ(tests::names_in(folder.path()), (std::vector<std::string>{"room.key", "room.pub"}));
}

TEST(SignCommands, WhatIsNoGoodKeyIsSaidOrRefused) {
  const tests::TemporaryFolder folder;
  const std::string blob = folder / "a.blob";
  const Blob bytes = make_blob(sample_robot(), sample_provenance());
  tests::write_bytes(blob, {bytes.begin(), bytes.end()});
  ASSERT_EQ(run_mdhcal({"keygen", "-o", folder / "room"}).exit_code, 0);
  const auto run = [&](const std::string& key, const std::string& counter, const std::string& from, const std::string& to) {
    return run_mdhcal({"sign", from, "--key", key, "--counter", counter, "-o", folder / to});
  };
  EXPECT_EQ(run(folder / "room.key", "7", blob, "seven.blob").err, "");
  const auto wrong = run(folder / "room.pub", "7", blob, "none");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("public key"), std::string::npos) << wrong.err;
  EXPECT_EQ(run_mdhcal({"show", folder / "seven.blob", "--key", folder / "room.key"}).exit_code, 2);
  const auto lower = run(folder / "room.key", "6", folder / "seven.blob", "six.blob");
  EXPECT_EQ(lower.exit_code, 0);
  EXPECT_NE(lower.err.find("goes down, from 7 to 6"), std::string::npos) << lower.err;
  ASSERT_EQ(chmod((folder / "room.key").c_str(), 0644), 0);
  EXPECT_NE(run(folder / "room.key", "7", blob, "b.blob").err.find("others than its owner"), std::string::npos);
}

// A blob whose bytes are in order and whose self-test fails: no controller would take it.
TEST(SignCommands, WhatTheLoaderRefusesIsNeitherSignedNorExported) {
  const tests::TemporaryFolder folder;
  Blob bytes = make_blob(sample_robot(), sample_provenance());
  bytes[blob_layout::double_vectors + 64 + 32 + 6] ^= 1;  // x of the first vector's pose
  const std::uint32_t crc = crc32(bytes.data(), blob_layout::crc);
  for (std::size_t k = 0; k < 4; ++k) bytes.at(blob_layout::crc + k) = static_cast<std::uint8_t>(crc >> (8 * k));
  tests::write_bytes(folder / "bad.blob", {bytes.begin(), bytes.end()});
  ASSERT_EQ(run_mdhcal({"show", folder / "bad.blob"}).exit_code, 0);
  ASSERT_EQ(run_mdhcal({"keygen", "-o", folder / "room"}).exit_code, 0);
  for (const auto& arguments : {std::vector<std::string>{"sign", folder / "bad.blob", "--key", folder / "room.key", "-o", folder / "out"},
                                std::vector<std::string>{"export", folder / "bad.blob", "--format", "bin", "-o", folder / "out"}}) {
    const auto run = run_mdhcal(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments[0];
    EXPECT_NE(run.err.find("self-test failed"), std::string::npos) << run.err;
  }
}

}  // namespace
}  // namespace mdhcal::offline
