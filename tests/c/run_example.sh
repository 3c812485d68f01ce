#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Runs a program of examples/c: run_example.sh EXPECTED PROGRAM [ARGUMENT]...
# It must succeed, and its output in one line match EXPECTED. Standard input ends after the first scan, or
# after a minute, which ends the event loop. With VALGRIND=1 under valgrind, without an error and without a leak.
set -euo pipefail
expected=$1
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
under=()
if [[ ${VALGRIND:-} ]]; then
  under=(valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=all)
fi
program=$(realpath "$1")
shift
cd "$scratch"
if [[ $program == *event_loop ]]; then
  touch output
  # shellcheck disable=SC2094  # it waits for what the program writes
  for ((i = 0; i < 600; ++i)); do
    if grep -q '^scan' output; then break; fi
    sleep 0.1
  done | "${under[@]}" "$program" "$@" >output
else
  "${under[@]}" "$program" "$@" >output
fi
if ! tr '\n' ' ' <output | grep -qE "$expected"; then
  echo "The output does not match '$expected':" >&2
  cat output >&2
  exit 1
fi
