#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# run.sh MACHINE IMAGE [ARGUMENT...]: run a bare-metal image in QEMU, with semihosting for its arguments, output and exit
# status. MDHCAL_QEMU_OPTIONS adds options to QEMU.
set -euo pipefail
machine=$1 image=$2
shift 2
# A comma inside an option of QEMU is written twice.
arguments="arg=$(basename "$image")"
for argument in "$@"; do arguments+=",arg=${argument//,/,,}"; done
# shellcheck disable=SC2086
exec qemu-system-arm -M "$machine" -display none -monitor none -serial none ${MDHCAL_QEMU_OPTIONS:-} \
  -semihosting-config "enable=on,target=native,$arguments" -kernel "$image" </dev/null
