#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The programs of the README and of docs/install.md are equal to the examples; the files and commands
# that the documents name exist, and the documents that the sources name; so do options; a command line within a
# sentence is also in a block, and so is executed; no line of a document is too long; no figures of
# speech stand in documents, names, comments and messages. Links: check_limits.sh.
# Needs G4_DUMP and G4LIDAR_SOURCE_DIR.
set -euo pipefail
cd "$G4LIDAR_SOURCE_DIR"
here=tests/documents
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
shopt -s nullglob
documents=(./*.md docs/*.md docs/guide/*.md docs/lidars/*.md docs/design/*.md)
missing=0

# A program of a document is the source, but for the SPDX line and the sentence below it.
# expect_program <document> <language> <source>: the only program of the document in this language.
expect_program() {
  local blocks=$scratch/programs-$1-$2 block
  mkdir -p "$blocks"
  bash "$here/extract.sh" "$1" "$blocks"
  block=$(awk -F '\t' -v language="$2" '$2 == language { print $1 }' "$blocks/list")
  if ! diff "$blocks/block_$block.$2" <(tail -n +3 "$3"); then
    echo "The program in $1 differs from $3" >&2
    missing=1
  fi
}
expect_program README.md cpp examples/first_scan.cpp
expect_program docs/install.md cpp examples/first_points.cpp
expect_program docs/install.md c examples/c/first_scan.c

# Command lines in sentences of the documents that are executed: a verb, or the beginning of an executed line. The table
# of the README has lines that check_limits.sh executes.
spoken=(README.md docs/{errors,install,recordings,tool}.md docs/s[iy]m*.md docs/guide/*.md)
# shellcheck disable=SC2016 # the backquotes are those of Markdown
grep -E '^\|' README.md | grep -oE '`g4-dump [^`]*`' | tr -d '\140' >"$scratch/lines"
for document in "${spoken[@]}"; do
  mkdir -p "$scratch/$document"
  bash "$here/extract.sh" "$document" "$scratch/$document"
  while IFS=$'\t' read -r block language _ mark; do
    if [[ $language == sh && $mark != "not run:"* ]]; then cat "$scratch/$document/$block.sh"; fi
  done <"$scratch/$document/list" >>"$scratch/lines"
done
sed -i -E 's/^.*(g4-dump )/\1/; s/ +/ /g' "$scratch/lines"
# shellcheck disable=SC2016 # the backquotes are those of Markdown
while IFS=: read -r document words; do
  words=${words//\`/}
  if [[ $words =~ ^g4-dump\ ([a-z]+)$ ]]; then
    if "$G4_DUMP" "${BASH_REMATCH[1]}" --help >/dev/null 2>&1; then continue; fi
    echo "$document speaks of $words, which g4-dump does not know" >&2
    missing=1
  elif ! awk -v words="$words" 'index($0, words) == 1 { found = 1 } END { exit !found }' "$scratch/lines"; then
    echo "$document speaks of '$words', which is in no block that is run" >&2
    missing=1
  fi
done < <(grep -oE '`g4-dump [^`]*`' "${spoken[@]}" | sort --unique)

# Every path that a document names exists.
# shellcheck disable=SC2016 # the backquotes are those of Markdown
while IFS=: read -r document path; do
  path=${path//\`/}
  if [[ ! -e $path ]]; then
    echo "$document names $path, which is not there" >&2
    missing=1
  fi
done < <(grep -oE '`(scripts|tests|bench|docs|include|src|tools|ros|examples|cmake|fuzz|packaging|python|\.ci)(/[A-Za-z0-9_./-]+)?`' \
  "${documents[@]}" | sort --unique)

# Every option that a document names is one of a program. Those of other programs: apt, ros2 bag, ros2 topic.
others='--(no-install-recommends|qos-profile-overrides-path|keep-alive)'
programs=$(dirname "$G4_DUMP")
for command in $("$G4_DUMP" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
  "$G4_DUMP" "$command" --help
done >"$scratch/help"
"$G4_DUMP" --help >>"$scratch/help"
if [[ -x $programs/g4-serve && -x $programs/g4-ros2 ]]; then
  "$programs/g4-serve" --help >>"$scratch/help"
  "$programs/g4-ros2" --help >>"$scratch/help"
  # shellcheck disable=SC2016 # the backquotes are those of Markdown
  while IFS=: read -r document option; do
    option=${option//\`/}
    if [[ ! $option =~ ^$others$ ]] && ! grep -qE -e "(^|[ ,])$option([ =,[]|$)" "$scratch/help"; then
      echo "$document names the option $option, which no program has" >&2
      missing=1
    fi
  done < <(grep -oE '`--[a-z][a-z-]+' README.md SUPPORT.md docs/*.md docs/*/*.md | sort --unique)
fi

# The pages link to each other, so each package with one of them has all.
for list in debian/*.docs; do
  if ! diff debian/libg4lidar-dev.docs "$list"; then
    echo "debian/libg4lidar-dev.docs and $list name different documents" >&2
    missing=1
  fi
done

# Also every document that a header, a source or the tool names.
while read -r path; do
  if [[ ! -e $path ]]; then
    echo "$path is not there, and is named by:" >&2
    grep -rlF "$path" include src tools ros >&2
    missing=1
  fi
done < <(grep -rhoE 'docs/[A-Za-z0-9_./-]+\.md' include src tools ros | sort --unique)

# Lines of documents have at most 120 characters; rows of tables cannot be wrapped.
if awk 'length($0) > 120 && !/^\|/ { print FILENAME ":" FNR ": " $0; found = 1 } END { exit !found }' \
  "${documents[@]}" examples/*/*.md >&2; then
  echo "These lines are longer than 120 characters" >&2
  missing=1
fi

# What describes the project or a program means every lidar of the family, not the G4 alone.
described=(CMakeLists.txt debian/control package.xml pyproject.toml packaging/*.pc.in docs/reference/*Doxyfile
  python/g4lidar/__init__.py tools/*/main.cpp ros/*/package.xml)
if grep -nE '(^|[^-])YDLIDAR G4([^-]|$)' "${described[@]}" | grep -vF 'G4 and its family' >&2; then
  echo "These lines name the G4 where any lidar of its family is meant" >&2
  missing=1
fi

# Figures of speech, in documents, names, comments and messages alike (CONTRIBUTING.md, Style): as
# words, as parts of names between underscores, and as parts of names that begin with a capital letter.
figures='tells?|telling|told|says?|said|lives|twins?|ear|exam|rivals?|errands?|manners|portrait|noted|meanwhile|rote|pours?|poured|amid|strangers?|spoilt|forgives?|hurry|greets?|in.vain|wish|wishes|feeders?|whoever'
capitals=$(sed -E 's/(^|\|)(.)/\1\u\2/g' <<<"$figures")
searched=("${documents[@]}" include src tools ros examples tests scripts bench fuzz cmake packaging python .ci CMakeLists.txt)
if { grep -rniE "(^|[^[:alpha:]])($figures)([^[:alpha:]]|$)|[a-z]_well\>|\<all (is|was) well" "${searched[@]}" || true
  grep -rnE "[[:lower:][:digit:]]($capitals)([^[:lower:]]|$)" "${searched[@]}" || true; } | grep -v "^$here/check_words.sh:" >&2; then
  echo "These lines contain figures of speech: write the term of the field" >&2
  missing=1
fi
exit "$missing"
