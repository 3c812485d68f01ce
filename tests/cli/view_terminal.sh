#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# g4-dump view in a terminal: the walls are where they belong, keys, sizes, tmux, and the terminal after each end.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
"$G4_DUMP" --help | grep -q '^  view ' || {
  echo "SKIPPED: g4-dump has no view"
  exit 0
}
python=/usr/bin/python3 # that of the package python3-pyte
"$python" -c "import pyte" 2>/dev/null || {
  echo "SKIPPED: python3-pyte is not installed"
  exit 0
}
# Behind the lidar 1 m, ahead 2 m, to the left 1.5 m, to the right 1 m.
cat >room.txt <<'END'
wall -2 -1.5   1 -1.5
wall  1 -1.5   1  1
wall  1  1    -2  1
wall -2  1    -2 -1.5
lidar 0 0 0
END
exec "$python" "$G4LIDAR_SOURCE_DIR/tests/cli/view_terminal.py" "$G4_DUMP"
