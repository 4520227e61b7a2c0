// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace mdhcal::tests {

/// The path of a file of the shared measurement data: under $MDHCAL_SHARED_DATA, else ../shared/data beside the project.
std::string shared_data(const std::string& name);

/// Registers a test that reads shared data. Where the data is missing, the test fails if CI=true, and is otherwise left
/// out by name on stderr. Returns whether it was registered. Use the macro.
bool register_shared_data_test(const char* suite, const char* name, const char* file, int line,
                               ::testing::Test* (*factory)());

}  // namespace mdhcal::tests

/// TEST() for tests that read shared data.
#define MDHCAL_SHARED_DATA_TEST(suite, name)                                                           \
  class suite##_##name##_Test : public ::testing::Test {                                               \
    void TestBody() override;                                                                          \
  };                                                                                                   \
  [[maybe_unused]] const bool suite##_##name##_registered = ::mdhcal::tests::register_shared_data_test( \
      #suite, #name, __FILE__, __LINE__, []() -> ::testing::Test* { return new suite##_##name##_Test; }); \
  void suite##_##name##_Test::TestBody()
