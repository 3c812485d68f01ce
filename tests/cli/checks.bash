# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# What the tests of the man page and of the completions share. Sourced by them; needs bash.

# fail <words>...: ends the test.
fail() {
  echo "$*" >&2
  exit 1
}

# need <program>: without it the test is skipped.
need() {
  if ! command -v "$1" >/dev/null; then
    echo "SKIPPED: $1 is not installed"
    exit 0
  fi
}

# expect <what> <wanted> <offered>: one of the lines offered is wanted.
expect() {
  grep -qx -e "$2" <<<"$3" || fail "$1 does not offer $2, but: $3"
}
# refuse <what> <unwanted> <offered>
refuse() {
  if grep -qx -e "$2" <<<"$3"; then fail "$1 offers $2"; fi
}

# all_verbs: those of the help.
all_verbs() {
  "$G4_DUMP" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]*\) .*/\1/p'
}
# options_of <verb>: its long ones, from its help.
options_of() {
  "$G4_DUMP" "$1" --help | grep -oE '^  (-[a-zA-Z],)?--[a-z-]+' | grep -oE -e '--[a-z-]+'
}
