#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# systemd accepts the units, for any form of source behind the @.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need systemd-analyze

for name in record ros2; do
  unit="$PWD/g4lidar-$name@.service"
  # Any program that exists: only the unit is checked.
  sed "s,@g4_dump@,$G4_DUMP,;s,@g4_ros2@,$G4_DUMP," "$G4LIDAR_SOURCE_DIR/packaging/systemd/g4lidar-$name@.service.in" >"$unit"
  if grep -n '@g4_' "$unit"; then fail "a name is left"; fi
  code=0
  words=$(systemd-analyze verify --man=no "$unit" 2>&1) || code=$?
  # What is wrong with other units of this machine is not ours.
  if ((code != 0)) || grep -F 'g4lidar' <<<"$words"; then
    echo "systemd-analyze verify ended with $code: $words"
    exit 1
  fi
done
