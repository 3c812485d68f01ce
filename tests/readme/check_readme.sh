#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The program in the README is examples/first_points.cpp, and prints what the README shows; the files
# and commands that the README names are there, and so are the documents that the sources name. Wants
# G4_DUMP, FIRST_POINTS and G4LIDAR_SOURCE_DIR.
set -euo pipefail
cd "$G4LIDAR_SOURCE_DIR"

# block <language>: the first fenced block of that language.
block() {
  awk -v fence='```'"$1" '$0 == fence && !seen { inside = seen = 1; next }
                          $0 == "```" { inside = 0 }
                          inside' README.md
}

# The SPDX line and the sentence below it are not shown.
if ! diff <(block cpp) <(tail -n +3 examples/first_points.cpp); then
  echo "The program in README.md differs from examples/first_points.cpp" >&2
  exit 1
fi

# The program, fed as the README says, prints what the README says.
shown=$(block text)
lines=$(wc -l <<<"$shown")
set +o pipefail # head ends before the others
printed=$("$G4_DUMP" sim --seconds 1 --seed 1 2>/dev/null | "$FIRST_POINTS" | head -n "$lines")
set -o pipefail
if ! diff <(echo "$shown") <(echo "$printed"); then
  echo "The program prints other points than README.md shows" >&2
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
