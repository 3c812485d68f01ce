#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# scripts/demo and scripts/test show the progress of a build (scripts/build.sh): on a terminal once a
# second; elsewhere one line for each build, and one every 30 s. Needs G4LIDAR_SOURCE_DIR.
set -euo pipefail
cat >build.sh <<'LINES'
source "$G4LIDAR_SOURCE_DIR/scripts/build.sh"
# A build that ends when its progress has been shown in the file $1, after 60 s at the latest.
slow_build() {
  echo '[3/7] Building CXX object'
  for ((i = 0; i < 600; ++i)); do
    if [[ ! $1 ]] || grep -qF '[3/7]' "$1"; then return 0; fi
    sleep 0.1
  done
}
run_quietly "Building it" slow_build "$1"
LINES

rm -f terminal
bash build.sh '' >file
grep -qE '^Building it \.\.\. [0-9]+ s$' file
(($(wc -l <file) == 1))
# shellcheck disable=SC2094 # the build waits for what is written
G4LIDAR_PROGRESS_SECONDS=1 bash build.sh lines >lines
grep -qE '^Building it \.\.\. \[3/7\] [0-9]+ s$' lines
grep -qE '^Building it \.\.\. [0-9]+ s$' <(tail -n 1 lines)
script --quiet --flush --return --command "bash build.sh terminal" terminal </dev/null >/dev/null
grep -qE 'Building it \.\.\. \[3/7\] [0-9]+ s' terminal
grep -qE 'Building it \.\.\. [0-9]+ s' terminal # the last line has the time
