# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# bash with the completion offers the verbs, their options and the words of a choice.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"

cp "$G4LIDAR_SOURCE_DIR"/packaging/completions/programs.bash .

# offered_by_bash <words behind g4-dump>: what follows the last of them.
offered_by_bash() {
  # shellcheck disable=SC2016 # the words are the inner shell's
  COMP_LINE="g4-dump $*" bash --norc -c 'source ./programs.bash
    COMP_POINT=${#COMP_LINE}; _g4lidar "$G4_DUMP"; printf "%s\n" "${COMPREPLY[@]}"'
}
mapfile -t verbs < <(all_verbs)
((${#verbs[@]} >= 4)) || fail "the help lists no commands"
for verb in "${verbs[@]}"; do
  offered=$(offered_by_bash "$verb" -)
  while read -r option; do
    expect "bash after $verb" "$option" "$offered"
  done < <(options_of "$verb")
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
