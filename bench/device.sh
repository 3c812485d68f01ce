#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The cost of the driver on a pty with the simulated G4 at the rate of a real connection, compared
# with its promises; fails if one is not kept. Times of a busy machine have no meaning, so this is
# for the nightly. Counts: bench/counts.sh. The median delay is promised to be 0.05 ms, or 1.5 times that of a bare loop
# of poll and read in the same runs, whichever is more.
#   bench/device.sh [SECONDS [REPETITIONS]]: how long each measurement in real time takes, 10 by default, and
#   how often each is repeated, 3 by default.
# The paces (each packet, batches of 20 ms, whole scans) take turns. Each cell is the median over the
# repetitions, and in brackets the 10th and 90th percentile; a ratio is of one repetition. The tail of the
# delay is that of the scans of all repetitions, and of those in which the host took no time from this virtual machine
# (steal in /proc/stat).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source bench/begin.sh
seconds=${1:-10}
repetitions=${2:-3}
build build/bench device_bench
bench=build/bench/bench/device_bench
scratch=$(mktemp -d -t g4lidar-device-bench.XXXXXX)
trap 'rm -rf "$scratch"' EXIT
source bench/row.sh
paces=(packets 20 scans)

# stolen: the time that the host of this virtual machine has taken from its processors so far, in 10 ms.
stolen() { awk '$1 == "cpu" { print $9 }' /proc/stat; }

# measure <pace> <repetition>: all of it, into one file. A tracer would disturb the times, so it has a run of its own.
measure() {
  local into=$scratch/$1.$2 before
  before=$(stolen)
  "$bench" delay "$seconds" "$1" >"$into"
  if (($(stolen) == before)); then sed -n 's/^delay_ms/undisturbed_ms/p' "$into" >"$into.undisturbed"; fi
  "$bench" stream "$seconds" "$1" >>"$into" 2>/dev/null
  strace -o "$scratch/calls" "$bench" stream 2 "$1" >/dev/null 2>&1
  awk '/"begin\\n"/ { on = 1; next } /"end\\n"/ { on = 0 } on { ++n } END { print "calls_per_s", n / 2 }' \
    "$scratch/calls" >>"$into"
}

for ((run = 1; run <= repetitions; ++run)); do
  for pace in "${paces[@]}"; do measure "$pace" "$run"; done
  "$bench" delay "$seconds" bare >"$scratch/bare.$run"
  join <(sort "$scratch/packets.$run") <(sort "$scratch/scans.$run") |
    awk '$1 == "cpu_s_per_minute" { print "cpu_ratio", $3 / $2 }' >"$scratch/ratio.$run"
done

# sorted <name> <pace>; percentile <p>: of sorted numbers.
sorted() { for ((run = 1; run <= repetitions; ++run)); do value "$1" "$scratch/$2.$run"; done | sort -g; }
percentile() { awk -v p="$1" '{ v[NR] = $1 } END { i = int((NR * p + 99) / 100); print v[i < 1 ? 1 : i] }'; }
median() { sorted "$1" "$2" | percentile 50; }
cell() { echo "$(median "$1" "$2") ($(sorted "$1" "$2" | percentile 10) to $(sorted "$1" "$2" | percentile 90))"; }

# pace_row <what> <name> [<maximum of whole scans>]
pace_row() {
  printf '| %s | %s | %s | %s | %s |\n' "$1" "$(cell "$2" packets)" "$(cell "$2" 20)" "$(cell "$2" scans)" "${3:-}"
  if [[ -n ${3:-} ]] && awk -v v="$(median "$2" scans)" -v most="$3" 'BEGIN { exit !(v > most) }'; then
    echo "Missed: $1, whole scans: $(median "$2" scans), promised $3" >&2
    missed=1
  fi
}

echo "| what | packets | batches of 20 ms | whole scans | promised of whole scans |"
echo "|---|---|---|---|---|"
pace_row "system calls per second" calls_per_s 100
pace_row "context switches per second" switches_per_s 60
pace_row "CPU seconds for a minute of streaming" cpu_s_per_minute
bare=$(median delay_median_ms bare)
# How fast a waiting program continues is a matter of the machine, too.
most=$(awk -v b="$bare" 'BEGIN { print (b * 1.5 > 0.05 ? b * 1.5 : 0.05) }')
pace_row "zero packet written to scan delivered, median, ms" delay_median_ms "$most"
echo "| zero packet written to parsed, in a bare loop of poll and read, median, ms | $(cell delay_median_ms bare) | | | |"
# tail_row <what> <name> <suffix>: the 99th percentile of all delays of these files, for each pace.
tail_row() {
  local pace files tails=()
  for pace in "${paces[@]}"; do
    files=("$scratch/$pace".[0-9]*"$3")
    tails+=("$(if [[ -e ${files[0]} ]]; then sed -n "s/^$2 //p" "${files[@]}" | sort -g | percentile 99; fi)")
  done
  printf '| the same, 99th percentile of %s, ms | %s | %s | %s | %s |\n' "$1" "${tails[@]}" "${4:-}"
  tail=${tails[2]}
}
quiet=$(find "$scratch" -name 'scans.*.undisturbed' | wc -l)
tail_row "all scans" delay_ms ""
tail_row "the scans of the $quiet of $repetitions runs without stolen time" undisturbed_ms .undisturbed 0.2
if awk -v v="$tail" 'BEGIN { exit !(v == "" || v > 0.2) }'; then
  echo "Missed: 99th percentile of the delay, whole scans: ${tail:-no run without stolen time}, promised 0.2" >&2
  missed=1
fi
pace_row "resident memory, KiB" resident_kib 4096
echo
heading
row "CPU time of whole scans, relative to packets" "$(median cpu_ratio ratio)" "" 0.35 "0.35"
row "zero packet to scan at the pace of packets, median" "$(median delay_median_ms packets)" ms "$most" "$most"
row "open and start" "$(median open_and_start_ms scans)" ms 100 "100"
row "from open to the first whole scan" "$(median first_scan_ms scans)" ms 2500 "2500"
"$bench" flood 10 >"$scratch/flood"
ratio=$(value flood_ratio "$scratch/flood")
row "bytes/s without rate limit, relative to counting and memory" "$ratio" "" "" "0.5"
row "scans lost without a rate limit" "$(value scans_lost "$scratch/flood")" "" 0 0
if awk -v r="$ratio" 'BEGIN { exit !(r < 0.5) }'; then
  echo "Missed: without a rate limit, $ratio of a counting reader and the driver in memory, promised 0.5" >&2
  missed=1
fi
exit "$missed"
