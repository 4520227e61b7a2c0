# SPDX-License-Identifier: MIT
# Cortex-M4 with the single-precision FPU: double is software.
set(MDHCAL_CPU_FLAGS "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16")
set(MDHCAL_MACHINE mps2-an386)
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
