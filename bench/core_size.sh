#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Prints the size of parser, decode and ring on a Cortex-M4: code, and state without the packet of
# carry; fails if they are larger than promised, 6 KiB and 256 bytes. Needs gcc-arm-none-eabi and
# libstdc++-arm-none-eabi-newlib of Debian.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

code_bound=6144
state_bound=256

object=$(mktemp -t g4lidar-core-size.XXXXXX.o)
trap 'rm -f "$object"' EXIT
arm-none-eabi-g++ -std=c++20 -Os -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard \
  -ffreestanding -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-unwind-tables -Wno-psabi \
  -DNDEBUG -Iinclude \
  -c bench/core_size/core.cpp -o "$object"

# The bytes of a symbol, and of all symbols of the kinds given.
of_symbol() { arm-none-eabi-nm --print-size --radix=d "$object" | awk -v name="$1" '$4 == name { print $2 + 0 }'; }
of_kinds() { arm-none-eabi-nm --print-size --radix=d "$object" | awk -v kinds="$1" '
  NF == 4 && index(kinds, $3) && $4 !~ /^size_of_/ { sum += $2 } END { print sum + 0 }'; }

code=$(of_kinds tTwWvV)
constants=$(of_kinds rR)
parser=$(of_symbol size_of_parser)
carry=$(of_symbol size_of_carry)
ring=$(of_symbol size_of_ring)
state=$((parser - carry))

printf '%-52s %6d bytes (promised: below %d)\n' "code of parser, decode and ring, Cortex-M4, -Os" "$code" "$code_bound"
printf '%-52s %6d bytes\n' "constants" "$constants"
printf '%-52s %6d bytes (promised: below %d)\n' "state of the parser without its carry" "$state" "$state_bound"
printf '%-52s %6d bytes\n' "the carry" "$carry"
printf '%-52s %6d bytes\n' "a ring of 512 points" "$ring"

if ((code + constants >= code_bound || state >= state_bound)); then
  echo "Larger than promised" >&2
  exit 1
fi
