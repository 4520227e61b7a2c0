# SPDX-License-Identifier: MIT
# mdhcal_warnings(TARGET): the strict warning set of this house.
function(mdhcal_warnings target)
  set(common -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Wcast-align -Wcast-qual -Wfloat-equal -Wundef
             -Wdouble-promotion)
  target_compile_options(${target} PRIVATE ${common} $<$<COMPILE_LANGUAGE:CXX>:-Wold-style-cast -Woverloaded-virtual>)
  # GCC 12 sees overlapping copies in plain sums of std::string (GCC bug 105651, gone in 13).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict>)
  endif()
  if(MDHCAL_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
