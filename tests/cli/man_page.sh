# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Every verb and option of the help stands in the man page.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"

"$G4_DUMP" --generate man >g4-dump.1
mapfile -t verbs < <(all_verbs)
((${#verbs[@]} >= 4)) || fail "the help lists no commands"
plain=$(sed 's/\\-/-/g; s/\\f[BIR]//g' g4-dump.1)
for verb in "${verbs[@]}"; do
  grep -qx ".SS $verb" <<<"$plain" || fail "the man page has no section $verb"
  while read -r option; do
    grep -q -e "$option" <<<"$plain" || fail "the man page lacks $option of $verb"
  done < <(options_of "$verb")
done
