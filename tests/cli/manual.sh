# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The man page and the completions: the programs that read them find nothing to complain of, and a
# shell that has loaded them offers the verbs, their options and the words of a choice.
# Looks where those programs are installed, and says where it did not.
set -euo pipefail

"$G4_DUMP" --generate man >g4-dump.1
"$G4_DUMP" --generate bash >g4-dump.bash
"$G4_DUMP" --generate zsh >_g4-dump
"$G4_DUMP" --generate fish >g4-dump.fish

failed=0
fail() {
  echo "$*" >&2
  failed=1
}
has() { command -v "$1" >/dev/null || { echo "without $1"; return 1; }; }

# expect <what> <wanted> <offered>: one of the lines offered is wanted.
expect() {
  grep -qx -e "$2" <<<"$3" || fail "$1 does not offer $2, but: $3"
}
# refuse <what> <unwanted> <offered>
refuse() {
  if grep -qx -e "$2" <<<"$3"; then fail "$1 offers $2"; fi
}

# Every verb and option of the help stands in the man page.
mapfile -t verbs < <("$G4_DUMP" --help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p')
((${#verbs[@]} >= 4)) || fail "the help lists no verbs"
plain=$(sed 's/\\-/-/g; s/\\f[BIR]//g' g4-dump.1)
for verb in "${verbs[@]}"; do
  grep -qx ".SS $verb" <<<"$plain" || fail "the man page has no section $verb"
  while read -r option; do
    grep -q -e "$option" <<<"$plain" || fail "the man page lacks $option of $verb"
    for shell in g4-dump.bash _g4-dump g4-dump.fish; do
      grep -q -e "${option#--}" $shell || fail "$shell lacks $option of $verb"
    done
  done < <("$G4_DUMP" "$verb" --help | grep -oE '^  (-[a-zA-Z],)?--[a-z-]+' | grep -oE -e '--[a-z-]+')
done

if has mandoc; then
  mandoc -T lint -W warning g4-dump.1 || fail "mandoc complains of the man page"
fi

offered_by_bash() {
  # shellcheck disable=SC2016 # the words are the inner shell's
  bash --norc -c 'source ./g4-dump.bash
    COMP_WORDS=(g4-dump "$@") COMP_CWORD=$#; _g4_dump; printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}
expect bash scan "$(offered_by_bash sc)"
refuse bash dump "$(offered_by_bash sc)"
expect bash --format "$(offered_by_bash scan --)"
expect bash jsonl "$(offered_by_bash scan --format j)"
expect bash --quiet "$(offered_by_bash scan -)"
expect bash sim: "$(offered_by_bash scan s)"
touch seen.bin
expect bash seen.bin "$(offered_by_bash decode se)"

if has zsh; then zsh -n _g4-dump || fail "zsh cannot read its completion"; fi

if has fish; then
  offered_by_fish() {
    env HOME="$PWD" XDG_CONFIG_HOME="$PWD" fish --no-config \
      -c "source g4-dump.fish; complete -C '$1'" 2>/dev/null | cut -f 1
  }
  expect fish scan "$(offered_by_fish 'g4-dump sc')"
  expect fish --format "$(offered_by_fish 'g4-dump scan --fo')"
  expect fish jsonl "$(offered_by_fish 'g4-dump scan --format j')"
fi
exit "$failed"
