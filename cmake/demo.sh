#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# demo.sh: from nothing to a calibrated robot. Installs what is missing, builds the tool, calibrates the published robot
# on nine poses and tests it on eighteen others. The build's own words go to build/demo.log.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p build
log=build/demo.log
trap 'echo "demo.sh stopped; the last lines of $log:" >&2; tail -20 "$log" >&2' ERR

bash cmake/setup.sh
source cmake/build.sh
echo "Building the tool (some minutes the first time) ..."
configure host >"$log" 2>&1
cmake --build build/host --parallel "$jobs" --target mdhcal >>"$log" 2>&1
trap - ERR

example=offline/examples/li2022
result=build/demo
command=(build/host/bin/mdhcal calibrate "$example/robot.toml" "$example/nine.csv" --test "$example/eighteen.csv"
         --base given --tool given -o "$result")
echo "\$ ${command[*]}"
"${command[@]}"
echo "Wrote:"
for file in calibration.blob corrected.toml result.json residuals.csv report.html; do
  test -s "$result/$file"
  echo "  $result/$file"
done
