#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# By how much the search delays the first scan of a lidar whose model is not named, for each model, idle and scanning.
# The lidars are simulated, in virtual time, so that each run prints the same. Fails if the 90th percentile is above the
# promise.
#   bench/search.sh [OPENINGS]: of each model, 20 by default.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source bench/begin.sh
build build/bench search_bench
build/bench/bench/search_bench "$@"
