#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# scripts/demo and scripts/test show the progress of a build on a terminal (scripts/build.sh), and one
# line for each build elsewhere. Needs G4LIDAR_SOURCE_DIR.
set -euo pipefail
cat >build.sh <<'LINES'
source "$G4LIDAR_SOURCE_DIR/scripts/build.sh"
# A build that ends when its progress has been shown, after 60 s at the latest.
slow_build() {
  echo '[3/7] Building CXX object'
  for ((i = 0; i < 600; ++i)); do
    if [[ ! -e terminal ]] || grep -qF '[3/7]' terminal; then return 0; fi
    sleep 0.1
  done
}
run_quietly "Building it" slow_build
LINES

rm -f terminal
bash build.sh >file
grep -qE '^Building it \.\.\. [0-9]+ s$' file
(($(wc -l <file) == 1))
script --quiet --flush --return --command "bash build.sh" terminal </dev/null >/dev/null
grep -qE 'Building it \.\.\. \[3/7\] [0-9]+ s' terminal
grep -qE 'Building it \.\.\. [0-9]+ s' terminal # the last line has the time
