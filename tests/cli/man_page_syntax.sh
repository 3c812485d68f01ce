# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# mandoc finds no fault in the man pages of all programs that are built.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need mandoc

pages=("$(dirname "$G4_DUMP")"/manual/*/*.1)
[[ -e ${pages[0]} ]] || fail "the build has made no man page"
mandoc -T lint -W warning "${pages[@]}"
