# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# g4-dump has a man page for each command of the help, with the same options, words and exit codes; and
# an overview with each command.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"

rm -rf pages
mkdir pages
"$G4_DUMP" --generate man pages
mapfile -t verbs < <(all_verbs)
((${#verbs[@]} >= 4)) || fail "the help lists no commands"
diff <(printf 'g4-dump%s.1\n' "" "${verbs[@]/#/-}" | sort) <(ls pages) || fail "the pages are not those of the commands"

# plain <page>: its text, without minus signs and fonts.
plain() {
  sed 's/\\-/-/g; s/\\f[BIR]//g' "pages/$1.1"
}
# section <heading>: of the page on standard input.
section() {
  awk -v heading=".SH $1" '/^\.SH / { here = $0 == heading; next } here'
}
# has <page> <line>: one of the lines on standard input is this one.
has() {
  grep -xF -e "$2" >/dev/null || fail "the page $1 has no line: $2"
}
# descriptions <command>...: those of options and arguments, which begin at column 37 of the help of the command.
# Lines of "Excludes:" can reach over it.
descriptions() {
  "$@" --help | awk 'substr($0, 1, 36) ~ /^(  (-|[A-Z]).* | *)$/ && substr($0, 37) ~ /^[^ ]/ { print substr($0, 37) }' \
    | grep -vxE "Print this help message and exit|--.*"
}
# options_of_page <page>: the long names of the options that the page describes.
options_of_page() {
  plain "$1" | section OPTIONS | awk '/^\.SS Options of every command/ { exit }
    last == ".TP" && match($0, /--[a-z-]+/) { print substr($0, RSTART, RLENGTH) }
    { last = $0 }'
}
# exit_codes <command>...: those of its help.
exit_codes() {
  "$@" --help | tr '\n' ' ' | grep -oE 'Exit codes: .*' | grep -oE '(:|,) [0-9]+' | tr -dc '0-9\n'
}

for verb in "${verbs[@]}"; do
  page=g4-dump-$verb
  summary=$("$G4_DUMP" "$verb" --help | head -n 1)
  plain "$page" | section NAME | has "$page" "$page - $summary"
  plain g4-dump | section COMMANDS | grep -xF -A 1 ".BR $page (1)" | has g4-dump "$summary."
  diff <(options_of "$verb" | grep -vx -e --help | sort --unique) <(options_of_page "$page" | sort --unique) \
    || fail "the options of the page $page and of the help differ"
  while read -r words; do
    plain "$page" | sed 's/ Cannot be used with .*//' | has "$page" "$words."
  done < <(descriptions "$G4_DUMP" "$verb")
  diff <(exit_codes "$G4_DUMP" "$verb") <(plain "$page" | section '"EXIT STATUS"' | sed -n 's/^\.B //p') \
    || fail "the exit codes of the page $page and of the help differ"
  plain "$page" | section '"SEE ALSO"' | grep "^.BR g4-dump (1)" >/dev/null || fail "the page $page does not name g4-dump(1)"
done
diff <(exit_codes "$G4_DUMP") <(plain g4-dump | section '"EXIT STATUS"' | sed -n 's/^\.B //p') \
  || fail "the exit codes of the overview and of the help differ"
"$G4_DUMP" --help | sed -n '/Other sources:$/,/^Data goes/s/^  \([^ ].*[^ ]\)  .*/\1/p' >forms
(($(wc -l <forms) >= 5)) || fail "the help lists no forms of SOURCE"
while read -r form; do
  plain g4-dump | section SOURCES | has g4-dump "$form"
done <forms
for variable in NO_COLOR G4LIDAR_SIM_DIR; do
  plain g4-dump | section ENVIRONMENT | has g4-dump ".B $variable"
done
if grep -l VERB pages/*.1; then fail "these pages name a command VERB"; fi
