#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# check_limits.sh refuses a project with a mistake, for each kind of mistake, with the expected words; it accepts one
# without. Needs G4_DUMP, G4LIDAR_SOURCE_DIR, ROBOT and FIRST_SCAN.
# shellcheck disable=SC2016 # the backquotes are those of Markdown
set -euo pipefail
here=$G4LIDAR_SOURCE_DIR/tests/documents
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=0

# make_project [<command>]: a project without a mistake, with this command in its table.
make_project() {
  rm -rf "$scratch/project"
  mkdir -p "$scratch/project/docs/guide"
  cd "$scratch/project"
  {
    printf '%s\n' '# A project' '' '[The guide](docs/guide/README.md#the-second-one), [promises](docs/promises.md).' ''
    printf '%s\n' '| I want to ... | command |' '|---|---|' "| see a scan | ${1-"\`g4-dump scan -n 1 sim:\`"} |"
  } >README.md
  printf '%s\n' '# Guide' '' '## The `second` one' '' '[Back](../../README.md)' >docs/guide/README.md
  printf '%s\n' '# Promises' '' '| promise | test |' '|---|---|' '| It works. | `tests/it` |' >docs/promises.md
  printf '%s\n' '# Maps' >docs/maps.md
  printf '%s\n' '# Support' >SUPPORT.md
  printf '%s\n' '# Contributing' >CONTRIBUTING.md
}

# expect <right
# wrong> <name> [<words of the message>]: checks the project.
expect() {
  local output verdict=right
  output=$(G4LIDAR_SOURCE_DIR=$scratch/project bash "$here/check_limits.sh" 2>&1) || verdict=wrong
  if [[ $verdict != "$1" || ($# -gt 2 && $output != *"$3"*) ]]; then
    printf '%s should be %s, and is %s:\n%s\n' "$2" "$1" "$verdict" "$output" >&2
    failed=1
  fi
}

# words <number>: so many words of a sentence; lines <number>: empty lines.
words() { seq "$1" | sed 's/.*/word/' | paste -s -d ' '; }
lines() { seq "$1" | sed 's/.*//'; }

make_project
expect right "a project without a mistake"

make_project
lines 143 >>README.md
expect right "a first page of 150 lines"
echo >>README.md
expect wrong "a first page of 151 lines" "README.md has 151 lines, at most 150"

make_project
lines 300 >docs/maps.md
expect right "a page of 300 lines"
echo >>docs/maps.md
expect wrong "a page of 301 lines" "docs/maps.md has 301 lines, at most 300"

make_project
lines 301 >docs/guide/README.md
printf '## The second one\n' >>docs/guide/README.md
expect wrong "a chapter of 302 lines" "docs/guide/README.md has 302 lines"

make_project
printf '\n%s.\n%s.\n' "$(words 25)" "$(words 25)" >>docs/promises.md
expect right "two sentences of 25 words"
for text in "$(words 26)." "$(words 13)
$(words 13)" "- $(words 26)" "| $(words 26) | \`test\` |" "[$(words 20)](https://example.org) $(words 6)"; do
  for page in README.md SUPPORT.md CONTRIBUTING.md docs/promises.md docs/guide/README.md; do
    make_project
    printf '\n%s\n' "$text" >>"$page"
    expect wrong "a sentence of 26 words in $page: ${text:0:9}" "a sentence of 26 words: word"
  done
done
make_project
printf '\n| %s. %s: `%s` | %s |\n' "$(words 20)" "$(words 9)" "$(words 30)" "$(words 25)" >>docs/promises.md
expect right "a row with sentences of 20, 10 and 25 words; code is one word"
make_project
printf '\n```text\n%s\n```\n' "$(words 40)" >>docs/promises.md
expect right "a long line in a block"

make_project
echo '| It is fast. | measured once |' >>docs/promises.md
expect wrong "a promise without a test" "docs/promises.md:6: a promise without a test: It is fast."

make_project
echo '[Nothing](nothing.md)' >>docs/maps.md
expect wrong "a dead link" "docs/maps.md:2: a link to nothing.md, which is not there"
make_project
echo '[Nothing](guide/README.md#the-third-one)' >>docs/maps.md
expect wrong "a dead anchor" "a link to guide/README.md#the-third-one, a heading that is not there"
make_project
echo '[Nothing](#maps-2)' >>docs/maps.md
expect wrong "a dead anchor of the same page" "#maps-2, a heading that is not there"
make_project
printf '%s\n' '## Maps' '[Here](#maps-1)' '[The web](https://example.org/#nothing)' '`[](code.md)`' >>docs/maps.md
expect right "the second heading of the same name, the web, and code"

make_project '`g4-dump scan -n 1 sim: --no-such-option`'
expect wrong "a command that fails" "'g4-dump scan -n 1 sim: --no-such-option' ended with 2"
make_project '`g4-dump scan sim:?fault=mute`'
expect wrong "a command that prints nothing of what is expected" "ended with"
make_project '`g4-dump scan -n 1 /dev/ttyUSB99`'
expect wrong "a missing lidar" "'g4-dump scan -n 1 /dev/ttyUSB99' ended with 3"
make_project "\`g4-dump scan -n 1 sim:\` or \`g4-dump scan sim:none\`"
expect wrong "a second command that fails" "'g4-dump scan sim:none' ended with 2"
make_project '`g4-dump scan -n 1 sim:?seed=2`'
expect wrong "a command that works with sim: only" "'g4-dump scan -n 1?seed=2' ended with 2"
make_project '`true`'
expect wrong "a command with an unknown output" "this test does not know what 'true' is expected to print"
make_project 'no command'
expect wrong "a row without a command" "\"see a scan\": there is no command"
make_project '`scripts/slam nowhere.mcap`'
expect wrong "a command that no test executes" "'scripts/slam nowhere.mcap' is in no block of docs/maps.md"
make_project
sed -i 's/I want to/You want to/' README.md
expect wrong "no table" 'README.md has no table'
exit "$failed"
