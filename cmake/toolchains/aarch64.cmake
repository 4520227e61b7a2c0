# SPDX-License-Identifier: MIT
# AArch64 Linux.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(MDHCAL_TRIPLE aarch64-linux-gnu)
set(MDHCAL_QEMU qemu-aarch64)
include("${CMAKE_CURRENT_LIST_DIR}/linux-cross.cmake")
