#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The programs in the README are examples/live_scan.cpp and examples/first_points.cpp, and print what the
# README shows; the files and commands that the documents name are there, links lead somewhere, and so
# do the documents that the sources name.
# Wants G4_DUMP, FIRST_POINTS, LIVE_SCAN and G4LIDAR_SOURCE_DIR.
set -euo pipefail
cd "$G4LIDAR_SOURCE_DIR"

# block <language> <number>: so many of the fenced blocks of that language, from 1.
block() {
  awk -v fence='```'"$1" -v number="$2" '$0 == fence { inside = ++seen == number; next }
                                         $0 == "```" { inside = 0 }
                                         inside' README.md
}

# shown_is <number> <source>: the program of that number is the source, but for the SPDX line and the
# sentence below it.
shown_is() {
  if ! diff <(block cpp "$1") <(tail -n +3 "$2"); then
    echo "Program $1 in README.md differs from $2" >&2
    exit 1
  fi
}
shown_is 1 examples/live_scan.cpp
shown_is 2 examples/first_points.cpp

# The program, on a simulated G4, prints what the README says, but for the measured numbers.
shown=$(block text 1)
lines=$(wc -l <<<"$shown")
scratch=$(mktemp -d)
"$G4_DUMP" sim --link "$scratch/g4" 2>/dev/null &
trap 'kill %1 2>/dev/null || true; rm -rf "$scratch"' EXIT
for ((i = 0; i < 300; ++i)); do
  if [[ -e $scratch/g4 ]]; then break; fi
  sleep 0.1
done
set +o pipefail # head ends before the others
printed=$(timeout 60 "$LIVE_SCAN" "$scratch/g4" | head -n "$lines")
set -o pipefail
form='s/[+-]/S/g; s/[0-9]+/N/g; s/ +/ /g'
if ! diff <(sed -E "$form" <<<"$shown") <(sed -E "$form" <<<"$printed"); then
  echo "The program prints other lines than README.md shows" >&2
  exit 1
fi

# The program that decodes prints the very same points, everywhere.
points=$(block text 2)
set +o pipefail
printed=$("$G4_DUMP" sim --seconds 1 --seed 1 2>/dev/null | "$FIRST_POINTS" \
  | head -n "$(wc -l <<<"$points")")
set -o pipefail
if ! diff <(echo "$points") <(echo "$printed"); then
  echo "examples/first_points.cpp prints other points than README.md shows" >&2
  exit 1
fi

# Every path that a document names exists, and every link leads to a file.
missing=0
# shellcheck disable=SC2016 # the backquotes are those of Markdown
while IFS=: read -r document path; do
  path=${path//\`/}
  if [[ ! -e $path ]]; then
    echo "$document names $path, which is not there" >&2
    missing=1
  fi
done < <(grep -oE '`(scripts|tests|bench|docs|include|src|tools|examples|cmake|fuzz|packaging|\.ci)(/[A-Za-z0-9_./-]+)?`' \
  ./*.md docs/*.md docs/design/*.md | sort --unique)
while IFS=: read -r document link; do
  link=${link#*](}
  link=${link%%[#)]*}
  if [[ -n $link && ! -e ${document%/*}/$link ]]; then
    echo "$document has a link to $link, which is not there" >&2
    missing=1
  fi
done < <(grep -oE '[^[]\]\([A-Za-z0-9_./#-]+\)' ./*.md docs/*.md docs/design/*.md | sort --unique)

# And every document that a header, a source or the tool names.
while read -r path; do
  if [[ ! -e $path ]]; then
    echo "$path is not there, and is named by:" >&2
    grep -rlF "$path" include src tools >&2
    missing=1
  fi
done < <(grep -rhoE 'docs/[A-Za-z0-9_./-]+\.md' include src tools | sort --unique)
exit "$missing"
