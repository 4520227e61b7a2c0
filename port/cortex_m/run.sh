#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# run.sh MACHINE IMAGE [ARGUMENT...]: run a bare-metal image in QEMU, with semihosting for its arguments, output and exit
# status; 71 if QEMU was ended from outside, which reports success itself. MDHCAL_QEMU_OPTIONS adds options to QEMU.
set -euo pipefail
machine=$1 image=$2
shift 2
# A comma inside an option of QEMU is written twice.
arguments="arg=$(basename "$image")"
for argument in "$@"; do arguments+=",arg=${argument//,/,,}"; done

# Passes the lines on, and succeeds if QEMU said that a signal ended it.
watch_errors() {
  local line ended=1
  while IFS= read -r line || [[ -n "$line" ]]; do
    printf '%s\n' "$line" >&2
    if [[ "$line" == qemu-system-arm:\ terminating\ on\ signal* ]]; then ended=0; fi
  done
  return "$ended"
}

# Whoever kills this script ends the emulator with it.
together=()
if command -v setpriv >/dev/null; then together=(setpriv --pdeathsig KILL); fi
exec 3> >(watch_errors)
watcher=$!
status=0
# shellcheck disable=SC2086
"${together[@]}" qemu-system-arm -M "$machine" -display none -monitor none -serial none ${MDHCAL_QEMU_OPTIONS:-} \
  -semihosting-config "enable=on,target=native,$arguments" -kernel "$image" </dev/null 2>&3 3>&- || status=$?
exec 3>&-
if wait "$watcher"; then status=71; fi
exit "$status"
