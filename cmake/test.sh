#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# test.sh [PRESET...]: installs what is missing, builds and runs every test of the presets named, or of all of them. With
# CI=true warnings are errors, and tests whose data is missing fail.
set -euo pipefail
cd "$(dirname "$0")/.."

presets=("$@")
if [[ ${#presets[@]} -eq 0 ]]; then
  bash cmake/setup.sh test cross  # CMake itself may be among what is missing
  # In two steps: the status of a command inside <( ) is lost.
  listed="$(cmake --list-presets=test)"
  mapfile -t presets < <(sed -n 's/^ *"\([^"]*\)".*/\1/p' <<<"$listed")
elif [[ "${presets[*]}" == host ]]; then
  bash cmake/setup.sh test
else
  bash cmake/setup.sh test cross
fi
if [[ ${#presets[@]} -eq 0 ]]; then
  echo "CMake lists no test preset; expected those of CMakePresets.json." >&2
  exit 1
fi
source cmake/build.sh

options=()
if [[ "${CI:-}" == true ]]; then options+=(-DMDHCAL_WERROR=ON); fi

failed=()
for preset in "${presets[@]}"; do
  echo "== $preset"
  if ! { configure "$preset" "${options[@]}" && cmake --build "build/$preset" --parallel "$jobs" &&
         ctest --preset "$preset" --no-tests=error -j "$jobs"; }; then
    failed+=("$preset")
  fi
done
if [[ ${#failed[@]} -gt 0 ]]; then
  echo "Failed: ${failed[*]}" >&2
  exit 1
fi
echo "Passed: ${presets[*]}"
