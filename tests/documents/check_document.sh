#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Executes a document: check_document.sh BLOCKS [N]
# BLOCKS is the output of extract.sh. Without N the command lines and the CMake projects are
# executed, in order and in one scratch directory, and the shown outputs are compared; with N the
# program of that number is run, and its output compared.
#
# Programs get a simulated G4 as argument and recorded bytes on standard input; programs that run
# until ^C get SIGINT when they have printed something. In command lines /dev/ttyUSB0 is a simulated
# G4, and /tmp the scratch directory. CONTRIBUTING.md describes the marks.
#
# Python blocks are run with PYTHON (python3 by default) and the argument sim:, if it can import g4lidar. If a document has
# nothing else to run, its check is skipped. check_document.sh BLOCKS python runs the Python blocks only.
#
# LIDAR=NAME=VALUE is an option of the simulated G4. Needs G4_DUMP; for command lines PROGRAMS, directories for PATH, and for projects PREFIX, the
# prefix of the installed library. Prints errors only.
set -euo pipefail
blocks=$(cd "$1" && pwd)
only=${2:-}
document=${DOCUMENT:-$blocks}

scratch=$(mktemp -d)
g4=$scratch/ttyUSB0
leave() {
  local left
  mapfile -t left < <(jobs -p)
  if ((${#left[@]} > 0)); then kill "${left[@]}" 2>/dev/null || true; fi
  wait 2>/dev/null || true
  rm -rf "$scratch"
}
trap leave EXIT
mkdir "$scratch/here"
ln -s "$(realpath "$(dirname "${BASH_SOURCE[0]}")/../../scripts")" "$scratch/here/scripts"
cd "$scratch/here"
export G4_DUMP
set -m # a background job can be interrupted, and is a process group that ends as a whole
PATH=${PROGRAMS:-}${PROGRAMS:+:}$(dirname "$G4_DUMP"):$PATH

# refuse <line> <words>...: prints what is wrong with the document at this line, and ends.
refuse() {
  echo "$document:$1: ${*:2}" >&2
  for name in out err; do
    if [[ -s $scratch/$name ]]; then sed "s/^/  ${name}: /" "$scratch/$name" | head -n 40 >&2; fi
  done
  exit 1
}

# await <path>: waits until it exists, or with a pattern a path that matches.
await() {
  local i
  for ((i = 0; i < 600; ++i)); do
    if compgen -G "$1" >/dev/null; then return 0; fi
    sleep 0.05
  done
  return 1
}

# A simulated G4 at $g4, started at its first use.
need_g4() {
  if [[ -e $g4 ]]; then return 0; fi
  "$G4_DUMP" sim ${LIDAR:+--device "$LIDAR"} --link "$g4" >/dev/null 2>"$scratch/simulator" &
  await "$g4" || { echo "g4-dump sim created no device" >&2; exit 1; }
}

# Whether programs waited for a processor for more than 0.2 s since this check began: then the simulated lidar stalls,
# and the doctor (exit code 9) is right.
waited_us() { sed -n 's/^some.*total=//p' /proc/pressure/cpu 2>/dev/null || true; }
waited_before=$(waited_us)
was_busy() {
  local now
  now=$(waited_us)
  ((${now:-0} - ${waited_before:-0} > 200000))
}

# interrupted <lines> <command>...: runs it until it has printed so many lines, or ends; returns its
# exit code. With 0 lines it ends by itself.
interrupted() {
  local lines=$1 pid i code=0
  shift
  "$@" >"$scratch/out" 2>"$scratch/err" &
  pid=$!
  for ((i = 0; i < 1200; ++i)); do
    if ! kill -0 "$pid" 2>/dev/null; then break; fi
    if ((lines > 0 && $(wc -l <"$scratch/out") >= lines)); then break; fi
    sleep 0.05
  done
  kill -INT -- "-$pid" 2>/dev/null || true
  wait "$pid" || code=$?
  return "$code"
}

# compare <line> <shown> <mark>: the first lines of the output must be those. If numbers may differ,
# a separate number must be zero in both or in neither.
compare() {
  local form='' at=$1 shown=$2
  if [[ $3 == *numbers ]]; then
    local zero='s/(^|[][ (=|\t]|":)0+(\.0+)?([] ,;)%|}]|\.( |$)|$)/\1Z\3/g'
    form="$zero; $zero"'; s/[+-]([0-9])/S\1/g; s/[0-9]+/N/g; s/ +/ /g; s/N(\.N)+/N/g'
  fi
  if ! diff <(sed -E "$form" "$shown") \
    <(head -n "$(wc -l <"$shown")" "$scratch/out" | sed -e "s#$g4#/dev/ttyUSB0#g; s#$scratch#/tmp#g" | sed -E "$form"); then
    refuse "$at" "the output differs"
  fi
}

# run_line <line> <mark> <command>: executes one command line, as a user would type it.
run_line() {
  local at=$1 mark=$2 words=$3 code=0 wanted=0
  words=${words//\/tmp\//$scratch/}
  words=${words//\/dev\/ttyUSB0/$g4}
  if [[ $mark == "the only lidar" ]]; then words=$(sed -E "s@[[:space:]]*([#|]|\$)@ $g4 \1@" <<<"$words"); fi
  if [[ $words == *"$g4"* ]]; then need_g4; fi
  if [[ $mark == "until ^C" ]]; then
    interrupted 1 bash -c "$words" </dev/null || code=$?
    if ((code == 130)); then code=0; fi
  else
    if [[ $mark == "exit "* ]]; then wanted=${mark#exit }; fi
    # On a busy machine the doctor may find faults of the machine.
    local right=0 wrong=0 need=1 most=0
    if [[ $mark == "three of four" ]]; then need=3 most=1; fi
    while ((right < need && wrong <= most)); do
      set +e
      eval "$words" >"$scratch/out" 2>"$scratch/err" </dev/null
      code=$?
      set -e
      if ((code == wanted)); then right=$((right + 1)); else wrong=$((wrong + 1)); fi
    done
    # A reader that reads only the beginning ends the writers.
    if [[ $words == *"|"* ]] && ((code == 141)); then code=0; fi
  fi
  if ((code == 9 && wanted == 0)) && was_busy; then
    echo "$document:$at: '$3' found faults on a busy machine: not counted"
    code=0
  fi
  if ((code != wanted)); then refuse "$at" "'$3' ended with $code"; fi
  # A simulated device must be available before the next line.
  if [[ $words == *"&" ]]; then
    local link
    while read -r _ link; do
      await "$link" || refuse "$at" "'$3' created no $link"
    done < <(grep -oE -e '--link [^ ]+' <<<"$words")
    if [[ $words == *--register* ]]; then
      await "$G4LIDAR_SIM_DIR/*" || refuse "$at" "'$3' registered no device"
    fi
  fi
}

# run_lines <first line> <mark> <file>: executes each of its command lines. The output is that of
# the last one.
run_lines() {
  local at=$1 line words='' first=$1
  while IFS= read -r line; do
    words+=$line
    if [[ $words == *\\ ]]; then
      words=${words%\\}
    else
      if [[ -n $words ]]; then run_line "$first" "$2" "$words"; fi
      words=''
      first=$((at + 1))
    fi
    at=$((at + 1))
  done <"$3"
}

# can_import_g4lidar: whether the Python module is installed.
can_import_g4lidar() { "${PYTHON:-python3}" -c 'import g4lidar' 2>/dev/null; }

# run_python <line> <file>: runs it as a program.
run_python() {
  local program=$scratch/block.py code=0
  sed "s#/dev/ttyUSB0#$g4#g" "$2" >"$program"
  if grep -q "$g4" "$program"; then need_g4; fi
  "${PYTHON:-python3}" "$program" sim: >"$scratch/out" 2>"$scratch/err" </dev/null || code=$?
  if ((code != 0)); then refuse "$1" "this program ended with $code"; fi
}

# build_project <line> <file>: configures and builds it, with an empty program.
build_project() {
  local project=$scratch/project-$1
  mkdir -p "$project"
  cp "$2" "$project/CMakeLists.txt"
  printf '#include <g4lidar/core/scan_assembler.hpp>\nint main() {}\n' >"$project/main.cpp"
  cmake -S "$project" -B "$project/build" >"$scratch/out" 2>&1 || refuse "$1" "CMake refuses this"
  cmake --build "$project/build" >"$scratch/out" 2>&1 || refuse "$1" "this does not build"
}

# go_through: all blocks except the programs.
go_through() {
  local number language line mark last=none ran=0 skipped=0
  export CMAKE_PREFIX_PATH=${PREFIX:-}
  while IFS=$'\t' read -r number language line mark <&3; do
    local file=$blocks/$number.$language
    if [[ $mark == "not run:"* ]]; then
      last=none
      continue
    fi
    if [[ $mark == "file "* ]]; then
      mkdir -p "$(dirname "${mark#file }")"
      cp "$file" "${mark#file }"
      continue
    fi
    if [[ $language == python ]] && ! can_import_g4lidar; then
      skipped=1 last=skipped
      continue
    fi
    if [[ $only == python && $language != python && ! ($language == text && $last == python) ]]; then
      last=skipped
      continue
    fi
    if [[ $last == skipped && $language == text ]]; then continue; fi
    if [[ $language != text ]]; then ran=1; fi
    case $language in
      python) run_python "$line" "$file" ;;
      sh) run_lines "$line" "$mark" "$file" ;;
      cmake) build_project "$line" "$blocks/block_$number.cmake" ;;
      text)
        if [[ $last == sh || $last == python ]]; then compare "$line" "$file" "$mark"; fi
        if [[ $last == none ]]; then refuse "$line" "this output belongs to no command"; fi
        ;;
    esac
    last=$language
  done 3<"$blocks/list"
  if ((skipped && !ran)); then
    echo "SKIPPED: the Python module g4lidar is not installed"
    exit 77
  fi
}

# run_program: runs the program of the block `only`; the following text is its output.
run_program() {
  local program=$1 number language line mark at=0 shown='' how='' lines=0 code=0
  while IFS=$'\t' read -r number language line mark; do
    if ((number == only)); then
      at=$line
      if [[ $mark == "until ^C" ]]; then lines=1; fi
    fi
    if ((number == only + 1)) && [[ $language == text && $mark == output* ]]; then
      shown=$blocks/$number.text
      how=$mark
      if ((lines > 0)); then lines=$(wc -l <"$shown"); fi
    fi
  done <"$blocks/list"
  need_g4
  "$G4_DUMP" sim --seconds 1 --seed 1 >"$scratch/recorded.bin"
  interrupted "$lines" "$program" "$g4" <"$scratch/recorded.bin" || code=$?
  if ((code != 0)); then refuse "$at" "this program ended with $code"; fi
  if [[ ! -s $scratch/out ]]; then refuse "$at" "this program prints nothing"; fi
  if [[ -n $shown ]]; then compare "$at" "$shown" "$how"; fi
}

if [[ -n $only && $only != python ]]; then run_program "${PROGRAM:?}"; else go_through; fi
