#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# setup.sh [GROUP...]: installs the Debian packages of cmake/packages.txt that are missing: those without a group, and
# those of the groups named ("test", "cross"). Nothing missing: it says nothing. Without the right to install, or off Debian, it
# names what to install and stops.
set -euo pipefail
list="$(dirname "$0")/packages.txt"

# In two steps: the status of a command inside <( ) is lost.
listed="$(grep -v -e '^#' -e '^$' "$list")" || { echo "$list names no package; expected those that the build needs." >&2; exit 1; }
wanted=()
while read -r package group _; do
  if [[ -z "$group" || " $* " == *" $group "* ]]; then wanted+=("$package"); fi
done <<<"$listed"

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  # The C++ libraries come by CMake's FetchContent; programs cannot.
  missing=()
  for program in cmake c++ git gnuplot; do
    command -v "$program" >/dev/null || missing+=("$program")
  done
  if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi
  echo "This is not Debian, and these programs are missing: ${missing[*]}." >&2
  echo "Install them and what these Debian packages hold, then run this again: ${wanted[*]}" >&2
  exit 1
fi

missing=()
for package in "${wanted[@]}"; do
  status="$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)"
  [[ "$status" == "install ok installed" ]] || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi

as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "These packages are missing: ${missing[*]}" >&2
    echo "Install them as root, then run this again: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing: ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq >&2
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
