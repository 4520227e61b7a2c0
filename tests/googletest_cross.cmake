# SPDX-License-Identifier: MIT
# GoogleTest for a target is built from its sources: those of Debian's package `googletest`, else fetched.
if(EXISTS /usr/src/googletest/googletest/CMakeLists.txt)
  set(FETCHCONTENT_SOURCE_DIR_GOOGLETEST /usr/src/googletest)
endif()
set(BUILD_GMOCK OFF)
set(INSTALL_GTEST OFF)
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
  set(gtest_disable_pthreads ON)
endif()
FetchContent_Declare(googletest GIT_REPOSITORY https://github.com/google/googletest.git GIT_TAG v1.13.0 GIT_SHALLOW ON)
FetchContent_MakeAvailable(googletest)
target_compile_options(gtest PRIVATE -O1)  # more to compile than to run
if(NOT TARGET GTest::gtest_main)
  add_library(GTest::gtest_main ALIAS gtest_main)
endif()
if(CMAKE_SYSTEM_NAME STREQUAL "Generic")
  # Without newlib's strict-ANSI subset of POSIX, and with the two file calls that it lacks.
  target_compile_definitions(gtest PUBLIC _POSIX_C_SOURCE=200809L PATH_MAX=1024 GTEST_HAS_STREAM_REDIRECTION=0)
  target_sources(gtest PRIVATE "${CMAKE_CURRENT_LIST_DIR}/port/newlib_gaps.c")
endif()
