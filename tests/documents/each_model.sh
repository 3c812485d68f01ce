#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs programs with a simulated lidar of each model: each_model.sh PROGRAM...
# Each must end with exit code 0 and print something. Needs G4_DUMP, for the words of the models. Prints failures only.
set -euo pipefail
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
at_once=8 # they wait most of the time

"$G4_DUMP" scan --model none sim: 2>"$scratch/refused" && exit 1
words=$(sed -n 's/.* is not one of \(.*\)\. See.*/\1/p' "$scratch/refused")
IFS=' ' read -ra models <<<"${words//,/}"
if ((${#models[@]} < 30)); then
  echo "only ${#models[@]} models: $(cat "$scratch/refused")" >&2
  exit 1
fi

# run_one <program> <model>: once more where a busy machine has delayed the simulated lidar.
run_one() {
  local name code attempt
  name=$(basename "$1").$2
  for attempt in 1 2 3; do
    code=0
    timeout 100 "$1" "sim:?model=$2" >"$scratch/$name.out" 2>&1 || code=$?
    if ((code == 0)) && [[ -s $scratch/$name.out ]]; then return 0; fi
    sleep "$attempt"
  done
  {
    echo "$(basename "$1") sim:?model=$2: exit code $code"
    sed 's/^/  /' "$scratch/$name.out"
  } >"$scratch/$name.failure"
}

for program in "$@"; do
  for model in "${models[@]}"; do
    while (($(jobs -pr | wc -l) >= at_once)); do wait -n; done
    run_one "$program" "$model" &
  done
done
wait
if compgen -G "$scratch/*.failure" >/dev/null; then
  cat "$scratch"/*.failure >&2
  exit 1
fi
