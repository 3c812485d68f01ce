# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# zsh with the completion offers the verbs, their options and the words of a choice.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need zsh

cp "$G4LIDAR_SOURCE_DIR"/packaging/completions/_programs .
PATH="$(dirname "$G4_DUMP"):$PATH" # it runs the program by the name that was typed

zsh -n _programs || fail "zsh cannot read its completion"
offered_by_zsh() {
  # shellcheck disable=SC2016 # the words are the inner shell's
  zsh -f -c 'words=(g4-dump "$@") CURRENT=$#words
    _describe() { print -rl -- $offered $begun }
    _files() { print files }
    completed() { source ./_programs }
    completed' zsh "$@"
}
expect zsh 'scan:Print whole revolutions' "$(offered_by_zsh sc)"
expect zsh '--format:Output format (text)' "$(offered_by_zsh scan --)"
expect zsh jsonl: "$(offered_by_zsh scan --format j)"
expect zsh 'sim\\::.*' "$(offered_by_zsh info '')"
expect zsh files "$(offered_by_zsh info '')"
