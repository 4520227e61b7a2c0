# SPDX-License-Identifier: MIT
# mdhcal_warnings(TARGET): the strict warning set of this house.
function(mdhcal_warnings target)
  set(common -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Wcast-align -Wcast-qual -Wfloat-equal -Wundef
             -Wdouble-promotion)
  target_compile_options(${target} PRIVATE ${common} $<$<COMPILE_LANGUAGE:CXX>:-Wold-style-cast -Woverloaded-virtual>)
  if(MDHCAL_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
