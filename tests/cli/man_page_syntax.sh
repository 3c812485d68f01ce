# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# mandoc finds nothing to complain of in the man page.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need mandoc

"$G4_DUMP" --generate man >g4-dump.1
mandoc -T lint -W warning g4-dump.1
