#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The number of points per second that g4-dump converts to csv on one core: from raw bytes and from
# a recording, with scans in it and without. Fails below the promised 10 million. The rate with the
# csv in a file is only printed, because it includes the time of the file system.
#   bench/convert.sh [MINUTES [LEAST]]: of a simulated lidar, 10 by default; fails below LEAST million, 10.
# Processor time without that of the disk, the median of five runs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/packages.sh
source scripts/build.sh
minutes=${1:-10}
promised=${2:-10}
need_packages "${packages_demo[@]}"
configure_preset release
build build/release g4-dump
g4_dump=build/release/g4-dump
scratch=$(mktemp -d -t g4lidar-convert-bench.XXXXXX)
trap 'rm -rf "$scratch"' EXIT
missed=0

# seconds <csv> <command>...: processor time, the median of five. The csv is a new file each time.
seconds() {
  local csv=$1 TIMEFORMAT='%U %S'
  shift
  for _ in 1 2 3 4 5; do
    if [[ -f $csv ]]; then rm "$csv"; fi
    { time "$@" >"$csv" 2>/dev/null; } 2>&1 | awk '{ print $1 + $2 }'
  done | sort -n | sed -n 3p
}

# rate <file> <csv>: million points per second.
rate() {
  awk -v points="$points" -v took="$(seconds "$2" "$g4_dump" convert -q "$1" - --to-format csv)" \
    'BEGIN { printf "%.1f", points / took / 1e6 }'
}

# row <what> <file>
row() {
  local rate
  rate=$(rate "$2" /dev/null)
  printf '| %-40s | %8s million points per second |\n' "$1" "$rate"
  printf '| %-40s | %8s million points per second |\n' "$1, to a file" "$(rate "$2" "$scratch/points.csv")"
  if awk -v rate="$rate" -v least="$promised" 'BEGIN { exit !(rate < least) }'; then
    echo "Missed: $1 to csv at $rate, promised $promised" >&2
    missed=1
  fi
}

"$g4_dump" sim --seconds $((60 * minutes)) -o "$scratch/long.bin"
"$g4_dump" convert -q "$scratch/long.bin" "$scratch/long.mcap"
"$g4_dump" record -q --no-scans "$scratch/long.bin" "$scratch/bare.mcap"
points=$("$g4_dump" convert -q "$scratch/long.bin" - --to-format csv | tail -n +2 | wc -l)
row "raw bytes" "$scratch/long.bin"
row "a recording with scans" "$scratch/long.mcap"
row "a recording without scans" "$scratch/bare.mcap"
exit "$missed"
