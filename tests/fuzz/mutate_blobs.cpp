// SPDX-License-Identifier: MIT
// mutate_blobs COUNT SEED FILE...: decodes COUNT mutations of the blobs in the files, their CRC repaired, and checks the
// invariants of docs/security.md on every accepted one. The bytes end where a page begins that may not be touched, so
// that a read behind them ends the program. A failure prints the seed and the number that replay it.
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "mdhcal/crc32.hpp"
#include "tests/fuzz/blob_invariants.hpp"

namespace {

using namespace mdhcal;
namespace at = blob_layout;

// splitmix64 (Steele, Lea, Flood 2014): a stream for each mutation, so that any one can be replayed alone.
class Random {
 public:
  explicit Random(std::uint64_t state) : state_(state) {}
  std::uint64_t operator()() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>((*this)() % n); }

 private:
  std::uint64_t state_;
};

using D = std::numeric_limits<double>;
constexpr double reals[] = {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, -1e300, 1000.0, -1000.0, 1000.0000000000001,
                            100.0, 0.05, -0.05, 0.050000000000000003, 12.566370614359172, 12.566370614359174, 1e-9, 0.99999999999, 1.00000000001, 0.0156,
                            D::quiet_NaN(), D::signaling_NaN(), D::infinity(), -D::infinity(), D::denorm_min(), D::min(), D::max(), -D::max()};
constexpr std::uint32_t words[] = {0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 0x7F, 0x80, 0xFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7F800000, 0x7FC00000, 0xFFFF0000};

void store(std::uint8_t* bytes, std::uint64_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes[k] = static_cast<std::uint8_t>(value >> (8 * k));
}

void mutate(std::uint8_t* bytes, Random& random, const std::vector<std::array<std::uint8_t, blob_size>>& bases) {
  switch (random.below(8)) {
    case 0: bytes[random.below(at::crc)] ^= static_cast<std::uint8_t>(1U << random.below(8)); break;
    case 1: bytes[random.below(at::crc)] = static_cast<std::uint8_t>(random()); break;
    case 2: store(bytes + 4 * random.below(at::crc / 4), words[random.below(std::size(words))], 4); break;
    case 3: {
      std::uint64_t bits = 0;
      const double value = reals[random.below(std::size(reals))];
      std::memcpy(&bits, &value, 8);
      store(bytes + 8 * random.below(at::crc / 8), bits, 8);
      break;
    }
    case 4: {  // nudge a real by a relative 2^-k
      std::uint8_t* p = bytes + 8 * random.below(at::crc / 8);
      double value = 0;
      std::memcpy(&value, p, 8);
      value += value * static_cast<double>(static_cast<std::int64_t>(random.below(3)) - 1) / static_cast<double>(1ULL << random.below(52));
      std::memcpy(p, &value, 8);
      break;
    }
    case 5: {  // a run of one byte
      const std::size_t from = random.below(at::crc);
      const std::size_t size = 1 + random.below(std::min<std::size_t>(64, at::crc - from));
      std::memset(bytes + from, static_cast<int>(words[random.below(std::size(words))] & 0xFFU), size);
      break;
    }
    case 6: {  // a run from another place of some blob
      const std::size_t size = 4 * (1 + random.below(48));
      const std::size_t from = 4 * random.below((at::crc - size) / 4 + 1);
      const std::size_t to = random.below(2) == 0 ? from : 4 * random.below((at::crc - size) / 4 + 1);
      std::memcpy(bytes + to, bases[random.below(bases.size())].data() + from, size);
      break;
    }
    default: {  // the header, where the counts and flags are
      bytes[random.below(64)] ^= static_cast<std::uint8_t>(1U << random.below(8));
      break;
    }
  }
}

// The CRC of a changed blob from that of the one before: CRCs are linear, so each changed byte adds its share.
class CrcUpdate {
 public:
  CrcUpdate() : share_(at::crc) {
    std::array<std::uint32_t, 256> byte{};
    for (std::uint32_t v = 0; v < 256; ++v) {
      std::uint32_t c = v;
      for (int bit = 0; bit < 8; ++bit) c = (c >> 1U) ^ ((c & 1U) != 0U ? 0xEDB88320U : 0U);
      byte[v] = c;
    }
    share_.back() = byte;
    for (std::size_t i = share_.size() - 1; i > 0; --i) {
      for (std::size_t v = 0; v < 256; ++v) share_[i - 1][v] = (share_[i][v] >> 8U) ^ byte[share_[i][v] & 0xFFU];
    }
  }
  std::uint32_t operator()(const std::uint8_t* before, const std::uint8_t* after, std::uint32_t crc) const {
    for (std::size_t block = 0; block < at::crc; block += 4) {
      std::uint32_t a = 0;
      std::uint32_t b = 0;
      std::memcpy(&a, before + block, 4);
      std::memcpy(&b, after + block, 4);
      if (a == b) continue;
      for (std::size_t i = block; i < block + 4; ++i) crc ^= share_[i][static_cast<std::uint8_t>(before[i] ^ after[i])];
    }
    return crc;
  }

 private:
  std::vector<std::array<std::uint32_t, 256>> share_;
};

std::uint8_t* guarded_page() {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const std::size_t room = (blob_size + page - 1) / page * page;
  void* all = mmap(nullptr, room + 2 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED) std::abort();
  auto* middle = static_cast<std::uint8_t*>(all) + page;
  if (mprotect(middle, room, PROT_READ | PROT_WRITE) != 0) std::abort();
  return middle + room - blob_size;  // ends where the forbidden page begins
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: mutate_blobs COUNT SEED FILE...\n");
    return 2;
  }
  const std::uint64_t count = std::strtoull(argv[1], nullptr, 10);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  std::vector<std::array<std::uint8_t, blob_size>> bases;
  for (int i = 3; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.size() != blob_size) continue;  // a corpus also has short ones
    std::memcpy(bases.emplace_back().data(), bytes.data(), blob_size);
  }
  if (bases.empty()) {
    std::fprintf(stderr, "no file of %zu bytes among those named\n", blob_size);
    return 2;
  }
  const CrcUpdate update;
  std::vector<std::uint32_t> crcs;
  for (const auto& base : bases) crcs.push_back(crc32(base.data(), at::crc));
  std::uint8_t* bytes = guarded_page();
  static BlobContent model;
  static BlobContent before;
  std::memset(static_cast<void*>(&before), 0x5A, sizeof before);
  std::array<std::uint64_t, 64> statuses{};
  for (std::uint64_t i = 0; i < count; ++i) {
    Random random(seed * 0x100000000U + i);
    const std::size_t base = random.below(bases.size());
    std::memcpy(bytes, bases[base].data(), blob_size);
    const std::size_t steps = 1 + random.below(random.below(4) == 0 ? 16 : 3);
    for (std::size_t step = 0; step < steps; ++step) mutate(bytes, random, bases);
    store(bytes + at::crc, update(bases[base].data(), bytes, crcs[base]), 4);
    const bool watched = i % 64 == 0;
    if (watched) std::memcpy(static_cast<void*>(&model), &before, sizeof model);
    const Status status = decode(bytes, blob_size, DecodeOptions{}, model);
    ++statuses[static_cast<std::size_t>(status) % statuses.size()];
    const char* broken = nullptr;
    if (status == Status::ok) broken = fuzz::broken_invariant(bytes, model, i % 1024 == 0);
    if (status != Status::ok && watched && std::memcmp(&model, &before, sizeof model) != 0) broken = "untouched when refused";
    if (broken != nullptr) {
      std::printf("broken: \"%s\" by mutation %llu of seed %llu\n", broken, static_cast<unsigned long long>(i),
                  static_cast<unsigned long long>(seed));
      return 1;
    }
  }
  std::printf("%llu mutated blobs, every invariant held\n", static_cast<unsigned long long>(count));
  for (std::size_t s = 0; s < statuses.size(); ++s) {
    if (statuses[s] != 0) std::printf("%12llu  %s\n", static_cast<unsigned long long>(statuses[s]), status_text(static_cast<Status>(s)));
  }
  return 0;
}
