# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# docs/scan.svg, which README.md shows, is what g4-dump draws of the simulated G4.
# After an intended change of the drawing, copy scan.svg from the scratch directory of this test to docs.
set -euo pipefail

rm -f walk.bin scan.svg
"$G4_DUMP" sim --seconds 3 --seed 1 -o walk.bin
"$G4_DUMP" scan -q walk.bin -n 1 -f svg -o scan.svg
cmp scan.svg "$G4LIDAR_SOURCE_DIR/docs/scan.svg"
