# SPDX-License-Identifier: MIT
# mdhcal_unity(TARGET): compile its files eight at a time, so that Eigen, CLI11 and GoogleTest are read once for all eight;
# a clean build takes half the time. Who edits one file configures with -DMDHCAL_UNITY=OFF.
# Not for the libraries of the controller nor for the fuzzers: their files are what a linker leaves out.
option(MDHCAL_UNITY "Compile the host tool and the tests several files at a time" ON)
function(mdhcal_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD "${MDHCAL_UNITY}" UNITY_BUILD_BATCH_SIZE 8)
endfunction()
