#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The program in the README is examples/live_scan.cpp, and prints such lines as the README shows; the
# files and commands that the README names are there, and so are the documents that the sources name.
# Wants G4_DUMP, FIRST_POINTS, LIVE_SCAN and G4LIDAR_SOURCE_DIR.
set -euo pipefail
cd "$G4LIDAR_SOURCE_DIR"

# block <language>: the first fenced block of that language.
block() {
  awk -v fence='```'"$1" '$0 == fence && !seen { inside = seen = 1; next }
                          $0 == "```" { inside = 0 }
                          inside' README.md
}

# The SPDX line and the sentence below it are not shown.
if ! diff <(block cpp) <(tail -n +3 examples/live_scan.cpp); then
  echo "The program in README.md differs from examples/live_scan.cpp" >&2
  exit 1
fi

# The program, on a simulated G4, prints what the README says, but for the measured numbers.
shown=$(block text)
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

# The example that decodes prints the same points everywhere.
points='60.672 degrees 3670.50 mm
60.952 degrees 3660.25 mm
61.233 degrees 3650.50 mm
61.514 degrees 3640.75 mm'
set +o pipefail
printed=$("$G4_DUMP" sim --seconds 1 --seed 1 2>/dev/null | "$FIRST_POINTS" | head -n 4)
set -o pipefail
if ! diff <(echo "$points") <(echo "$printed"); then
  echo "examples/first_points.cpp prints other points" >&2
  exit 1
fi

# Every path that is named exists.
missing=0
# shellcheck disable=SC2016 # the backquotes are those of Markdown
for path in $(grep -oE '`(scripts|tests|bench|docs|include|src|tools|examples|cmake|fuzz|\.ci)/[A-Za-z0-9_./-]+`' README.md \
  | tr -d '`' | sort --unique); do
  if [[ ! -e $path ]]; then
    echo "README.md names $path, which is not there" >&2
    missing=1
  fi
done

# And every document that a header, a source or the tool names.
while read -r path; do
  if [[ ! -e $path ]]; then
    echo "$path is not there, and is named by:" >&2
    grep -rlF "$path" include src tools >&2
    missing=1
  fi
done < <(grep -rhoE 'docs/[A-Za-z0-9_./-]+\.md' include src tools | sort --unique)
exit "$missing"
