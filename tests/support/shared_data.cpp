// SPDX-License-Identifier: MIT
#include "tests/support/shared_data.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

namespace mdhcal::tests {

namespace {

std::string folder() {
  const char* given = std::getenv("MDHCAL_SHARED_DATA");
  return given != nullptr && *given != 0 ? given : MDHCAL_SOURCE_DIR "/../shared/data";
}

class Missing : public ::testing::Test {
  void TestBody() override { FAIL() << "the shared data is missing: " << folder(); }
};

}  // namespace

std::string shared_data(const std::string& name) { return folder() + '/' + name; }

bool register_shared_data_test(const char* suite, const char* name, const char* file, int line,
                               ::testing::Test* (*factory)()) {
  const bool present = std::filesystem::is_directory(folder());
  const char* ci = std::getenv("CI");
  if (!present && (ci == nullptr || std::string_view(ci) != "true")) {
    std::fprintf(stderr, "left out: %s.%s (no shared data in %s)\n", suite, name, folder().c_str());
    return false;
  }
  if (!present) factory = []() -> ::testing::Test* { return new Missing; };
  ::testing::RegisterTest(suite, name, nullptr, nullptr, file, line, factory);
  return true;
}

}  // namespace mdhcal::tests
