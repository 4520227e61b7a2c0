/* SPDX-License-Identifier: MIT */
/* A program of somebody else in C. */
#include <mdhcal.h>

int main(void) { return mdhcal_abi_version() == MDHCAL_ABI_VERSION ? 0 : 1; }
