# SPDX-License-Identifier: MIT
# Armv7 Linux with a hardware FPU.
set(CMAKE_SYSTEM_PROCESSOR arm)
set(MDHCAL_TRIPLE arm-linux-gnueabihf)
set(MDHCAL_QEMU qemu-arm)
include("${CMAKE_CURRENT_LIST_DIR}/linux-cross.cmake")
