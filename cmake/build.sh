# SPDX-License-Identifier: MIT
# Sourced by demo.sh and test.sh from the project's root: configure PRESET [OPTION...].
jobs="$(nproc 2>/dev/null || echo 2)"

# Ninja and ccache are used where they are; a tree that was configured before keeps its generator.
configure() {
  local preset="$1"
  shift
  if [[ ! -e "build/$preset/CMakeCache.txt" ]] && command -v ninja >/dev/null; then
    set -- -G Ninja "$@"
  fi
  if command -v ccache >/dev/null; then
    export CMAKE_C_COMPILER_LAUNCHER="${CMAKE_C_COMPILER_LAUNCHER-ccache}"
    export CMAKE_CXX_COMPILER_LAUNCHER="${CMAKE_CXX_COMPILER_LAUNCHER-ccache}"
  fi
  cmake --preset "$preset" "$@"
}
