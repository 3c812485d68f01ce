#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The cost of the driver on a pty with the simulated G4 at the rate of a real connection, compared
# with its promises; fails if one is not kept. Times of a busy machine have no meaning, so this is
# for the nightly. Counts: bench/counts.sh.
#   bench/device.sh [SECONDS]: how long each measurement in real time takes, 10 by default.
# A delay is the median of three measurements of so many seconds each.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/packages.sh
source scripts/build.sh
seconds=${1:-10}
need_packages "${packages_bench[@]}"
configure_preset bench
build build/bench device_bench
bench=build/bench/bench/device_bench
scratch=$(mktemp -d -t g4lidar-device-bench.XXXXXX)
trap 'rm -rf "$scratch"' EXIT
source bench/row.sh

for run in 1 2 3; do "$bench" delay "$seconds" >"$scratch/delay.$run"; done
# delay <name>: the median of the three.
delay() {
  for run in 1 2 3; do value "$1" "$scratch/delay.$run"; done | sort -n | sed -n 2p
}

heading
row "zero packet written to scan delivered, median" "$(delay delay_median_ms)" ms 0.05 "0.05"
row "the same, 99th percentile" "$(delay delay_p99_ms)" ms
row "open and start" "$(delay open_and_start_ms)" ms 100 "100"
row "from open to the first whole scan" "$(delay first_scan_ms)" ms 2500 "2500"
"$bench" stream "$seconds" >"$scratch/stream" 2>/dev/null
row "CPU seconds for a minute of streaming" "$(value cpu_s_per_minute "$scratch/stream")" s
row "context switches per second" "$(value switches_per_s "$scratch/stream")" ""
row "peak memory" "$(value peak_memory_kib "$scratch/stream")" KiB
"$bench" flood 10 >"$scratch/flood"
ratio=$(value flood_ratio "$scratch/flood")
row "bytes/s without rate limit, by a counting reader" "$ratio" "" "" "0.7"
row "scans lost without a rate limit" "$(value scans_lost "$scratch/flood")" "" 0 0
if awk -v r="$ratio" 'BEGIN { exit !(r < 0.7) }'; then
  echo "Missed: without a rate limit, $ratio of a counting reader, promised 0.7" >&2
  missed=1
fi
exit "$missed"
