# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The man page and the completions: the programs that read them find nothing to complain of, and a
# shell that has loaded them offers the verbs, their options and the words of a choice.
# Looks where those programs are installed, and reports where it did not.
set -euo pipefail

"$G4_DUMP" --generate man >g4-dump.1
cp "$G4LIDAR_SOURCE_DIR"/packaging/completions/* .

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
mapfile -t verbs < <("$G4_DUMP" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
((${#verbs[@]} >= 4)) || fail "the help lists no commands"
plain=$(sed 's/\\-/-/g; s/\\f[BIR]//g' g4-dump.1)
for verb in "${verbs[@]}"; do
  grep -qx ".SS $verb" <<<"$plain" || fail "the man page has no section $verb"
  while read -r option; do
    grep -q -e "$option" <<<"$plain" || fail "the man page lacks $option of $verb"
  done < <("$G4_DUMP" "$verb" --help | grep -oE '^  (-[a-zA-Z],)?--[a-z-]+' | grep -oE -e '--[a-z-]+')
done

if has mandoc; then
  mandoc -T lint -W warning g4-dump.1 || fail "mandoc complains of the man page"
fi

# offered_by_bash <words behind g4-dump>: what follows the last of them.
offered_by_bash() {
  # shellcheck disable=SC2016 # the words are the inner shell's
  COMP_LINE="g4-dump $*" bash --norc -c 'source ./g4-dump.bash
    COMP_POINT=${#COMP_LINE}; _g4_dump "$G4_DUMP"; printf "%s\n" "${COMPREPLY[@]}"'
}
for verb in "${verbs[@]}"; do
  offered=$(offered_by_bash "$verb" -)
  while read -r option; do
    expect "bash after $verb" "$option" "$offered"
  done < <("$G4_DUMP" "$verb" --help | grep -oE '^  (-[a-zA-Z],)?--[a-z-]+' | grep -oE -e '--[a-z-]+')
done
expect bash scan "$(offered_by_bash sc)"
refuse bash dump "$(offered_by_bash sc)"
expect bash --format "$(offered_by_bash scan --)"
expect bash jsonl "$(offered_by_bash scan --format j)"
expect bash --quiet "$(offered_by_bash scan -)"
expect bash sim: "$(offered_by_bash scan s)"
expect bash csv "$(offered_by_bash scan --format=c)"
# bash splits at = and :, and replaces only what follows.
expect bash 8k "$(offered_by_bash set sample_rate=)"
expect bash 8k "$(offered_by_bash set sample_rate=8)"
expect bash on "$(offered_by_bash set protection=)"
refuse bash cw "$(offered_by_bash set sample_rate=)"
expect bash unplug "$(offered_by_bash sim --link x --fault un)"
expect bash serial: "$(offered_by_bash info ser)"
expect bash jsonl "$(offered_by_bash --format j)"
touch seen.bin
expect bash seen.bin "$(offered_by_bash decode se)"

# The scripts run the program by the name that was typed.
PATH="$(dirname "$G4_DUMP"):$PATH"
if has zsh; then
  zsh -n _g4-dump || fail "zsh cannot read its completion"
  offered_by_zsh() {
    # shellcheck disable=SC2016 # the words are the inner shell's
    zsh -f -c 'words=(g4-dump "$@") CURRENT=$#words
      _describe() { print -rl -- $offered $begun }
      _files() { print files }
      completed() { source ./_g4-dump }
      completed' zsh "$@"
  }
  expect zsh 'scan:Print whole revolutions' "$(offered_by_zsh sc)"
  expect zsh '--format:Output format (text)' "$(offered_by_zsh scan --)"
  expect zsh jsonl: "$(offered_by_zsh scan --format j)"
  expect zsh 'sim\\::.*' "$(offered_by_zsh info '')"
  expect zsh files "$(offered_by_zsh info '')"
fi

if has fish; then
  offered_by_fish() {
    env HOME="$PWD" XDG_CONFIG_HOME="$PWD" fish --no-config \
      -c "source g4-dump.fish; complete -C '$1'" 2>/dev/null | cut -f 1
  }
  expect fish scan "$(offered_by_fish 'g4-dump sc')"
  expect fish --format "$(offered_by_fish 'g4-dump scan --fo')"
  expect fish jsonl "$(offered_by_fish 'g4-dump scan --format j')"
  expect fish sample_rate=8k "$(offered_by_fish 'g4-dump set sample_rate=')"
  expect fish seen.bin "$(offered_by_fish 'g4-dump decode se')"
fi
exit "$failed"
