# SPDX-License-Identifier: MIT
# Cortex-M7 with the double-precision FPU.
set(MDHCAL_CPU_FLAGS "-mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16")
set(MDHCAL_MACHINE mps2-an500)
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
