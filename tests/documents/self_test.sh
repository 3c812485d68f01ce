#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A document with a mistake is refused, for each kind of mistake; a document without is accepted.
# Needs G4_DUMP, G4LIDAR_SOURCE_DIR and CXX.
set -euo pipefail
here=$G4LIDAR_SOURCE_DIR/tests/documents
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export DOCUMENT=scratch.md
mkdir "$scratch/modules" # with a module of this name
touch "$scratch/modules/g4lidar.py"
export PYTHONPATH=$scratch/modules
fence='```'
failed=0

# passes: whether the document on standard input is accepted; its programs are only compiled.
passes() {
  rm -rf "$scratch/blocks"
  cat >"$scratch/document.md"
  bash "$here/extract.sh" "$scratch/document.md" "$scratch/blocks" || return 1
  local program
  for program in "$scratch"/blocks/block_*.cpp; do
    if [[ -e $program ]]; then "$CXX" -std=c++20 -fsyntax-only "$program" || return 1; fi
  done
  bash "$here/check_document.sh" "$scratch/blocks"
}

# expect <right
# wrong> <name>: checks the document on standard input.
expect() {
  local output verdict=right
  output=$(passes 2>&1) || verdict=wrong
  if [[ $verdict != "$1" ]]; then
    printf '%s should be %s, and is %s:\n%s\n' "$2" "$1" "$verdict" "$output" >&2
    failed=1
  fi
}

# block <language> <line>...: a fenced block.
block() {
  printf '%s%s\n' "$fence" "$1"
  printf '%s\n' "${@:2}"
  printf '%s\n' "$fence"
}

expect right "an empty document" <<<"Words."
block sh 'echo one' 'test -d /tmp/' | expect right "command lines that succeed"
block sh 'echo one' 'false' 'true' | expect wrong "a command line that fails"
block sh 'g4-dump sim --no-such-option' | expect wrong "an option that is none"
block sh 'no-such-program' | expect wrong "a program that is none"
{ echo '<!-- test: exit 3 -->'; block sh '(exit 3)'; } | expect right "an expected failure"
{ echo '<!-- test: exit 3 -->'; block sh 'true'; } | expect wrong "a missing failure"
{ echo '<!-- test: not run: it would halt the machine -->'; block sh 'false'; } | expect right "a line with a reason"
{ echo '<!-- test: not run: -->'; block sh 'false'; } | expect wrong "a line without a reason"
{ echo '<!-- test: run -->'; block sh 'true'; } | expect wrong "an unknown mark"
{ echo '<!-- test: until ^C -->'; echo; block sh 'true'; } | expect wrong "a mark without a block"
{ echo '<!-- test: three of four -->'; block sh 'test -e once || { touch once; false; }'; } | expect right "one failure in four"
{ echo '<!-- test: three of four -->'; block sh 'test -e twice || { if test -e once; then touch twice; fi; touch once; false; }'; } \
  | expect wrong "two failures in four"
{ echo '<!-- test: three of four -->'; block sh 'false'; } | expect wrong "a permanent failure"
block bash 'true' | expect wrong "a language that is not known"
block '' 'true' | expect wrong "no language"
block text 'one' | expect wrong "an output that nobody compares"
{ block sh 'echo one'; echo '<!-- test: output -->'; block text 'one'; } | expect right "the output"
{ block sh 'echo one'; echo '<!-- test: output -->'; block text 'two'; } | expect wrong "another output"
{ block sh 'echo one'; echo '<!-- test: output -->'; block text 'one' 'two'; } | expect wrong "less output"
{ block sh 'echo 1.5 m'; echo '<!-- test: output, but for numbers -->'; block text '2.75 m'; } \
  | expect right "the output, but for numbers"
{ block sh 'echo 1.5 m'; echo '<!-- test: output, but for numbers -->'; block text '2.75 mm'; } \
  | expect wrong "another output beside the numbers"
{ echo '<!-- test: file one.txt -->'; block text 'one'; block sh 'grep -q one one.txt'; } | expect right "a file"
block sh 'g4-dump sim --link /tmp/g4 &' 'test -e /tmp/g4' | expect right "a device in the background"
block sh 'test -e /dev/ttyUSB0' | expect right "a device"
block cpp 'int main() {}' | expect right "a program"
block cpp 'int main() { return }' | expect wrong "a program that does not compile"
if command -v python3 >/dev/null; then
  block python 'import g4lidar' | expect right "a Python program"
  block python 'import g4lidar' 'raise SystemExit(1)' | expect wrong "a Python program that fails"
  { block python 'print("one")'; echo '<!-- test: output -->'; block text 'one'; } | expect right "the output of Python"
  { block python 'print("one")'; echo '<!-- test: output -->'; block text 'two'; } | expect wrong "another output of Python"
fi
for pair in '1.5 0' '0 2' '1 0.00'; do
  { block sh "echo lost: ${pair#* } points"; echo '<!-- test: output, but for numbers -->'; block text "lost: ${pair% *} points"; } \
    | expect wrong "a zero where there is none: $pair"
done
for line in '{"lost":%s,"of":7}' 'lost=%s' '[%s]' 'It has lost %s.'; do
  # shellcheck disable=SC2059 # the line is the format
  { block sh "echo '$(printf "$line" 3)'"; echo '<!-- test: output, but for numbers -->'; block text "$(printf "$line" 0)"; } \
    | expect wrong "a zero where there is none: $line"
done
{ block sh 'echo 0 lost of 12'; echo '<!-- test: output, but for numbers -->'; block text '0.0 lost of 15'; } | expect right "zero in both"
{ echo '<!-- test: in no_such_wrapper -->'; block cpp 'f();'; } | expect wrong "an unknown wrapper"
{ echo '<!-- test: in project -->'; block cmake 'find_package(no_such REQUIRED)'; } | expect wrong "an unknown package"
printf '%s\n' '- A list:' "  ${fence}sh" '  true' "  $fence" | expect wrong "an indented fence"
printf '%s\n' "${fence}sh" 'true' | expect wrong "a block without an end"

# examples <list> <line of a header>...: whether the examples of this header are those of the list.
examples() {
  mkdir -p "$scratch/headers"
  printf '%s\n' "$1" >"$scratch/examples.txt"
  printf '%s\n' "${@:2}" >"$scratch/headers/one.hpp"
  bash "$here/header_examples.sh" "$scratch/examples.txt" "$scratch/headers" >"$scratch/headers.md" 2>&1
}
if ! examples 'one.hpp 1 header_lidar' '/// Text.' '///' '///     open("/dev/ttyUSB0");' 'void f();' \
  || ! grep -qx 'open(device);' "$scratch/headers.md"; then
  echo "an example of a header is refused, or its port is not the simulated one:" >&2
  cat "$scratch/headers.md" >&2
  failed=1
fi
if examples '' '///' '///     open();'; then echo "an example that is not listed is not refused" >&2 && failed=1; fi
if examples 'one.hpp 1 text' '///' '///     open();'; then echo "code as text is not refused" >&2 && failed=1; fi
if examples 'one.hpp 2 text' '/// Text.'; then echo "an example that does not exist is not refused" >&2 && failed=1; fi
exit "$failed"
