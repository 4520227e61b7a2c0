# SPDX-License-Identifier: MIT
# Cortex-M55 with its double-precision FPU.
set(MDHCAL_CPU_FLAGS "-mcpu=cortex-m55 -mthumb -mfloat-abi=hard")
set(MDHCAL_MACHINE mps3-an547)
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
