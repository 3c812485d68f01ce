#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The cost of the driver and g4-dump, as counts, which do not depend on the load of the machine:
# instructions by callgrind, heap calls, system calls. Fails if a count is above its promise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source bench/begin.sh
build build/bench device_bench
configure_preset release
build build/release g4-dump
bench=build/bench/bench/device_bench
g4_dump=build/release/g4-dump
scratch=$(mktemp -d -t g4lidar-counts.XXXXXX)
trap 'rm -rf "$scratch"' EXIT
source bench/row.sh

# instructions <command>...: the number of executed instructions; the output is in $scratch/out.
instructions() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 >"$scratch/out" | sed -n 's/.*Collected : //p'
}

# The difference of two lengths is used, to exclude the start of the program.
# per_sample <bytes in a burst> [judged]: instructions of the driver per sample.
per_sample() {
  local scans counts=() samples=()
  for scans in 200 400; do
    counts+=("$(instructions "$bench" memory "$scans" "$@")")
    samples+=("$(value samples "$scratch/out")")
  done
  awk -v a="${counts[0]}" -v b="${counts[1]}" -v m="${samples[0]}" -v n="${samples[1]}" \
    'BEGIN { printf "%.1f", (b - a) / (n - m) }'
}

# per_point <suffix>: instructions of g4-dump convert to csv per point.
per_point() {
  local seconds counts=() points=()
  for seconds in 5 10; do
    counts+=("$(instructions "$g4_dump" convert -q "$scratch/$seconds.$1" - --to-format csv)")
    points+=("$(wc -l <"$scratch/out")")
  done
  awk -v a="${counts[0]}" -v b="${counts[1]}" -v m="${points[0]}" -v n="${points[1]}" \
    'BEGIN { printf "%.1f", (b - a) / (n - m) }'
}

# calls <pace>: system calls per second during four seconds of streaming.
calls() {
  strace -o "$scratch/calls" "$bench" stream 4 "$1" >"$scratch/stream" 2>/dev/null
  awk '/"begin\\n"/ { on = 1; next } /"end\\n"/ { on = 0 } on { ++n } END { printf "%.0f", n / 4 }' "$scratch/calls"
}

for seconds in 5 10; do
  "$g4_dump" sim --seconds "$seconds" -o "$scratch/$seconds.bin"
  "$g4_dump" convert -q "$scratch/$seconds.bin" "$scratch/$seconds.mcap"
done
heading
row "instructions per sample, bursts of 256 bytes" "$(per_sample 256)" "" 60 "60"
row "the same, bursts of 64 bytes" "$(per_sample 64)" ""
row "bursts of 256 bytes, with a running diagnosis" "$(per_sample 256 judged)" "" 110 "110"
# A model for each layout of samples; see core/model.hpp.
for model in x4 g6 tg30 g2 s4b scl t-mini t-mini-plus-sh; do
  row "the same, samples of a $model" "$(per_sample 256 "$model")" "" 78 "78"
done
row "instructions per point, convert of raw bytes to csv" "$(per_point bin)" "" 800 "800"
row "the same of a recording with scans" "$(per_point mcap)" "" 800 "800"
row "system calls per second, only scans taken" "$(calls scans)" "" 100 "100"
row "the same with batches of 20 ms" "$(calls 20)" "" 110 "110"
row "heap calls while streaming" "$(value heap_calls "$scratch/stream")" "" 0 0
exit "$missed"
