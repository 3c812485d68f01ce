#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What the dearest input costs the parser: instructions for each byte, counted by valgrind's
# callgrind, for inputs made to be dear and those that a search has found (bench/worst_case). Fails
# where one costs more than the bound, however the input is cut. The difference of two run lengths is
# taken, so that the start of the program does not count.
#
#   bench/worst_case.sh                   counts and checks
#   bench/worst_case.sh search [SECONDS]  searches for dearer input first, and counts what it found
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bound_in_bulk=150 # instructions for each byte, all of the input in one piece
bound_cut=400     # the same, cut in any way; the most is with one byte at a time

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${CXX:-g++}" -std=c++20 -O2 -DNDEBUG -Iinclude bench/worst_case/worst_case.cpp -o "$work/worst_case"

# instructions NAME PIECE BYTES: how many a run executes.
instructions() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$work/worst_case" run "$@" 2>&1 |
    sed -n 's/.*Collected : //p'
}

# cost NAME PIECE: tenths of an instruction for each byte.
cost() {
  local short=20000 long=60000
  echo $(((($(instructions "$1" "$2" "$long")) - $(instructions "$1" "$2" "$short")) * 10 / (long - short)))
}

failed=0
# check NAME PIECE BOUND: prints the cost and holds it against the bound.
check() {
  local tenths
  tenths=$(cost "$1" "$2")
  local verdict=
  if ((tenths > $3 * 10)); then
    verdict=" MORE THAN $3"
    failed=1
  fi
  printf '%8d.%d%s' $((tenths / 10)) $((tenths % 10)) "$verdict"
}

mapfile -t names < <("$work/worst_case" list | cut -f1)
if [[ ${1-} == search ]]; then
  for piece in 1 2 3 7 1000000; do
    mapfile -t found < <("$work/worst_case" search "${2-60}" "$piece" "$piece" | cut -d' ' -f2)
    names+=("${found[@]:0:2}")
  done
fi

echo "Instructions for each byte, by the size of the pieces (bound: $bound_cut; all in one: $bound_in_bulk)"
printf '%-26s%10s%10s%10s%10s\n' input 1 2 7 all
for name in "${names[@]}"; do
  printf '%-26.26s' "$name"
  for piece in 1 2 7; do check "$name" "$piece" $bound_cut; done
  check "$name" 1000000 $bound_in_bulk
  echo
done
exit $failed
