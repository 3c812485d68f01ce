#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# systemd accepts the unit, for any form of source behind the @.
set -euo pipefail
# shellcheck source=cli/checks.bash
source "${BASH_SOURCE%/*}/checks.bash"
need systemd-analyze

unit="$PWD/g4lidar-record@.service"
sed "s,@g4_dump@,$G4_DUMP," "$G4LIDAR_SOURCE_DIR/packaging/systemd/g4lidar-record@.service.in" >"$unit"
code=0
words=$(systemd-analyze verify --man=no "$unit" 2>&1) || code=$?
# What is wrong with other units of this machine is not ours.
if ((code != 0)) || grep -F 'g4lidar' <<<"$words"; then
  echo "systemd-analyze verify ended with $code: $words"
  exit 1
fi
