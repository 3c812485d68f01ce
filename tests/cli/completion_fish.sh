# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# fish with the completion offers the verbs, their options and the words of a choice.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need fish

cp "$G4LIDAR_SOURCE_DIR"/packaging/completions/programs.fish .
PATH="$(dirname "$G4_DUMP"):$PATH" # it runs the program by the name that was typed

offered_by_fish() {
  env HOME="$PWD" XDG_CONFIG_HOME="$PWD" fish --no-config \
    -c "source programs.fish; complete -C '$1'" 2>/dev/null | cut -f 1
}
expect fish scan "$(offered_by_fish 'g4-dump sc')"
expect fish --format "$(offered_by_fish 'g4-dump scan --fo')"
expect fish jsonl "$(offered_by_fish 'g4-dump scan --format j')"
expect fish sample_rate=8k "$(offered_by_fish 'g4-dump set sample_rate=')"
touch seen.bin
expect fish seen.bin "$(offered_by_fish 'g4-dump decode se')"
