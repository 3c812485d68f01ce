#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The cost of the most expensive known inputs of the parser: instructions per byte, counted with
# callgrind, for constructed inputs and for those that a search has found (bench/worst_case). Fails
# if one is above the bound, for any division of the input. The difference of two lengths is used,
# to exclude the start of the program.
#
#   bench/worst_case.sh                   counts and checks
#   bench/worst_case.sh search [SECONDS]  searches for more expensive inputs first, and counts those
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bound_in_bulk=150 # instructions per byte, all of the input in one piece
bound_cut=400     # the same, divided in any way; the maximum is with one byte at a time

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${CXX:-g++}" -std=c++20 -O2 -DNDEBUG -Iinclude bench/worst_case/worst_case.cpp -o "$work/worst_case"

# instructions NAME PIECE BYTES [MODEL]: the number of executed instructions.
instructions() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$work/worst_case" run "$@" 2>&1 |
    sed -n 's/.*Collected : //p'
}

# cost NAME[/MODEL] PIECE: tenths of an instruction per byte.
cost() {
  local short=20000 long=60000 name=${1%%/*} model=g4
  if [[ $1 == */* ]]; then model=${1#*/}; fi
  echo $(((($(instructions "$name" "$2" "$long" "$model")) - $(instructions "$name" "$2" "$short" "$model")) * 10 / (long - short)))
}

failed=0
# check NAME PIECE BOUND: prints the cost and compares it with the bound.
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
# Samples of 3 and of 4 bytes.
for name in overlapping_40 noise aa_55 info_in_info; do
  names+=("$name/t-mini" "$name/t-mini-plus-sh")
done
if [[ ${1-} == search ]]; then
  for piece in 1 2 3 7 1000000; do
    mapfile -t found < <("$work/worst_case" search "${2-60}" "$piece" "$piece" | cut -d' ' -f2)
    names+=("${found[@]:0:2}")
  done
fi

echo "Instructions per byte, by the size of the pieces (bound: $bound_cut; all in one: $bound_in_bulk)"
printf '%-30s%10s%10s%10s%10s\n' input 1 2 7 all
for name in "${names[@]}"; do
  printf '%-30.30s' "$name"
  for piece in 1 2 7; do check "$name" "$piece" $bound_cut; done
  check "$name" 1000000 $bound_in_bulk
  echo
done
exit $failed
