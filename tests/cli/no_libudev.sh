#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Without libudev.so.1 all works but discovery, whose error names it. An empty file hides the library. Needs G4_DUMP.
set -euo pipefail
mkdir -p hidden
: >hidden/libudev.so.1
export LD_LIBRARY_PATH=$PWD/hidden
for word in list watch info; do
  code=0
  arguments=("$word")
  if [[ $word == info ]]; then arguments+=(usb:1-1); fi
  "$G4_DUMP" "${arguments[@]}" >out 2>err </dev/null || code=$?
  ((code != 0)) || { echo "g4-dump $word lists ports without libudev" >&2; exit 1; }
  grep -q 'libudev\.so\.1: .*package libudev1' err || { echo "g4-dump $word does not name it: $(<err)" >&2; exit 1; }
done
"$G4_DUMP" scan -n 1 -q sim: | grep points >out
rm -f lidar # a link to the port of a simulator, which is a named port
"$G4_DUMP" sim --link lidar 2>sim.log &
trap 'kill $!; wait' EXIT
for ((i = 0; i < 600; ++i)); do
  if [[ -e lidar ]]; then break; fi
  sleep 0.1
done
"$G4_DUMP" info lidar | grep G4 >out
"$G4_DUMP" scan -n 1 -q lidar | grep points >out
