# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The versions of Python on this machine. Sourced by scripts; needs bash.

# find_pythons: prints "<minor> <program>" of each version of Python 3 that runs: those of PYTHONS (programs), or those
# in PATH and of pyenv.
find_pythons() {
  local each
  {
    if [[ ${PYTHONS:-} ]]; then
      tr ' ' '\n' <<<"$PYTHONS"
    else
      compgen -c python3. | grep -E '^python3\.[0-9]+$' || true
      compgen -G "${PYENV_ROOT:-$HOME/.pyenv}/versions/3.*/bin/python" || true
    fi
  } | while read -r each; do
    "$each" -c 'import sys; print(sys.version_info.minor, sys.executable)' 2>/dev/null || true
  done | sort --key=1,1n --unique
}
