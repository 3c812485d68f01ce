#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Extracts the blocks of a document, and makes complete programs of its C++: extract.sh DOCUMENT
# DIRECTORY
# Programs are DIRECTORY/block_N.cpp; unchanged ones are not written again.
set -euo pipefail
document=$1
directory=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
touch "$fresh/list"
awk -v out="$fresh" -f "$here/blocks.awk" "$document"

# wrap <wrapper> <fragment>: the wrapper with the fragment instead of its line @fragment@.
wrap() {
  if [[ ! -e $1 ]]; then
    echo "$document names $(basename "$1"), which is no wrapper" >&2
    exit 1
  fi
  sed -e "/@fragment@/ { r $2" -e 'd; }' "$1"
}

while IFS=$'\t' read -r number language _ mark; do
  if [[ $mark == "not run:"* ]]; then continue; fi
  case $language:$mark in
    cpp:"in "*) wrap "$here/wrappers/${mark#in }.cpp.in" "$fresh/$number.cpp" >"$fresh/block_$number.cpp" ;;
    c:"in "*) wrap "$here/wrappers/${mark#in }.c.in" "$fresh/$number.c" >"$fresh/block_$number.c" ;;
    c:*) cp "$fresh/$number.c" "$fresh/block_$number.c" ;;
    cpp:*) cp "$fresh/$number.cpp" "$fresh/block_$number.cpp" ;;
    cmake:"in "*) wrap "$here/wrappers/${mark#in }.cmake.in" "$fresh/$number.cmake" >"$fresh/block_$number.cmake" ;;
    cmake:*) cp "$fresh/$number.cmake" "$fresh/block_$number.cmake" ;;
  esac
done <"$fresh/list"

mkdir -p "$directory"
for path in "$fresh"/*; do
  if ! cmp -s "$path" "$directory/${path##*/}"; then cp "$path" "$directory"; fi
done
for path in "$directory"/*; do
  if [[ -f $path && ! -e $fresh/${path##*/} ]]; then rm "$path"; fi
done
