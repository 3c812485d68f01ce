#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The processor time of g4-dump view in terminals of 80x24 and 200x60, of a simulated lidar in another program. Fails
# above the promised 3 % of a core.
#   bench/view.sh [SECONDS]: for 20 seconds each by default.
# G4_DUMP=<path> uses an existing program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/packages.sh
source scripts/build.sh
source bench/row.sh
seconds=${1:-20}
if [[ -z ${G4_DUMP:-} ]]; then
  need_packages "${packages_bench[@]}" libncurses-dev
  configure_preset release
  build build/release g4-dump
  G4_DUMP=build/release/g4-dump
fi
scratch=$(mktemp -d -t g4lidar-view-bench.XXXXXX)
lidar=
terminal=
trap 'if [[ $terminal ]]; then echo q >&3; fi; if [[ $lidar ]]; then kill "$lidar"; fi; wait; rm -rf "$scratch"' EXIT
mkfifo "$scratch/keys"
exec 3<>"$scratch/keys"

# wait_for <command>...: until it succeeds.
wait_for() {
  for ((i = 0; i < 300; ++i)); do
    if "$@"; then return; fi
    sleep 0.1
  done
  echo "$* does not succeed" >&2
  return 1
}

# measure <columns> <rows>
measure() {
  TERM=xterm-256color LC_ALL=C.UTF-8 script -qfc "stty cols $1 rows $2; exec '$G4_DUMP' view '$scratch/g4'" /dev/null \
    <&3 >"$scratch/shown" &
  terminal=$!
  wait_for grep -q scans "$scratch/shown"
  local view begin size
  view=$(pgrep -P "$terminal")
  sleep 3 # the head speeds up
  size=$(stat -c %s "$scratch/shown")
  begin=$(ticks "$view")
  sleep "$seconds"
  row "g4-dump view at 7 Hz, $1x$2" "$(percent "$(($(ticks "$view") - begin))" "$seconds")" "% of a core" 3 "at most 3 %"
  row "what it writes to this terminal" "$((($(stat -c %s "$scratch/shown") - size) / seconds))" "bytes/s"
  echo q >&3
  wait "$terminal"
  terminal=
}

"$G4_DUMP" sim --link "$scratch/g4" &>/dev/null &
lidar=$!
wait_for test -e "$scratch/g4"
heading
measure 80 24
measure 200 60
exit "$missed"
