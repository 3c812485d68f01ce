# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# How the scripts configure and build: quietly on success, with all output on failure.
# Sourced by the scripts; needs bash.

# show_progress <name> <log>: shows the progress of the build that writes this log: on a terminal once
# a second, elsewhere as a line every 30 s (G4LIDAR_PROGRESS_SECONDS).
show_progress() {
  local begin=$SECONDS last=0 took step
  while kill -0 $$ 2>/dev/null; do
    took=$((SECONDS - begin))
    step=$(grep -oE '^\[ *[0-9]+(/[0-9]+|%)\]' "$2" | tail -n 1 || true)
    if [[ -t 1 ]]; then
      printf '\r\033[K%s ... %s %d s' "$1" "$step" "$took"
    elif ((took >= last + ${G4LIDAR_PROGRESS_SECONDS:-30})); then
      last=$took
      printf '%s%d s\n%s ... ' "${step:+$step }" "$took" "$1"
    fi
    sleep 1 >/dev/null 2>&1 # does not keep a pipe open when this process has ended
  done
}

# run_quietly <name> <command>...: prints one line, another one every 30 s, and the output of the
# command only if it fails.
run_quietly() {
  local what=$1 log code=0 begin=$SECONDS progress
  shift
  log=$(mktemp)
  printf '%s ... ' "$what"
  show_progress "$what" "$log" &
  progress=$!
  "$@" >"$log" 2>&1 || code=$?
  kill "$progress"
  wait "$progress" 2>/dev/null || true
  if [[ -t 1 ]]; then printf '\r\033[K%s ... ' "$what"; fi
  if ((code == 0)); then
    printf '%d s\n' "$((SECONDS - begin))"
  else
    echo failed
    cat "$log" >&2
  fi
  rm -f "$log"
  return "$code"
}

# ccache asks the compiler for the includes of a source, which saves a preprocessor run; it accepts
# precompiled headers; and two build directories may share equal objects.
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
export CCACHE_NOHASHDIR=${CCACHE_NOHASHDIR:-1}
# Clones of the project share them, too; but for the tests, whose precompiled header names its directory.
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD}

# configure <build directory> <cmake argument>...: with Ninja, or with make if Ninja is not
# installed. A build directory keeps its generator.
configure() {
  local directory=$1
  shift
  local launcher=()
  if command -v ccache >/dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  local generator=()
  if [[ ! -e $directory/CMakeCache.txt && -z ${CMAKE_GENERATOR:-} ]]; then
    generator=(-G "$(if command -v ninja >/dev/null; then echo Ninja; else echo "Unix Makefiles"; fi)")
  fi
  run_quietly "Configuring $directory" cmake -S . -B "$directory" "${generator[@]}" "${launcher[@]}" "$@"
}

# configure_preset <preset> <cmake argument>...: into build/<preset>.
configure_preset() {
  local preset=$1
  shift
  configure "build/$preset" --preset "$preset" "$@"
}

# build <build directory> [<target>...]: the targets, or all.
build() {
  local directory=$1
  shift
  local targets=()
  if (($# > 0)); then targets=(--target "$@"); fi
  run_quietly "Building $directory" cmake --build "$directory" --parallel "$(nproc)" "${targets[@]}"
}

# use_programs <program>...: G4_DUMP is g4-dump, G4_SERVE is g4-serve, and so on: a given one, or that of build/release.
use_programs() {
  local program name missing=()
  for program in "$@"; do
    name=${program//-/_}
    name=${name^^}
    if [[ -z ${!name:-} ]]; then missing+=("$program"); fi
    export "$name=$(realpath -m "${!name:-build/release/$program}")"
  done
  if ((${#missing[@]} == 0)); then return; fi
  configure_preset release
  build build/release "${missing[@]}"
}

# fetch <directory> <python> <package>...: a virtual environment of this Python with these packages of PyPI. Without a
# network the shell ends, with 77.
fetch() {
  if [[ -e $1/made_of && $(<"$1/made_of") == "${*:2}" ]]; then return; fi
  rm -rf "$1"
  "$2" -m venv "$1"
  if ! run_quietly "Fetching ${*:3}" "$1/bin/pip" install --quiet --disable-pip-version-check "${@:3}"; then
    echo "SKIPPED: ${*:3} could not be installed"
    exit 77
  fi
  echo "${*:2}" >"$1/made_of"
}

# report_tests: reads the results that ctest has written, and prints the skipped and the failed tests
# and the counts. A test in an executable that is one CTest test can be skipped, too.
report_tests() {
  awk '
    /<testcase / {
      match($0, /name="[^"]*"/)
      name = substr($0, RSTART + 6, RLENGTH - 7)
      passes = /status="run"/
      fails = /status="fail"/
      reason = ""
    }
    follows { reason = ": " $0; follows = 0 } # the line of GTEST_SKIP()
    /: Skipped$/ { follows = 1 }
    match($0, /SKIPPED: .*/) { reason = ": " substr($0, RSTART + 9) } # of a script
    /\[  SKIPPED \] .* ms\)$/ && (passes || fails) {
      sub(/ \([0-9]+ ms\)$/, "")
      sub(/.*SKIPPED \] (\[NON-XML-CHAR-0x1B\]\[m)?/, "") # the colour that follows
      ++skipped
      print "SKIPPED: " name ": " $0 reason
      reason = ""
    }
    /<\/testcase>/ {
      if (passes) ++passed
      else if (fails) { ++failed; print "FAILED: " name }
      else { ++skipped; print "SKIPPED: " name reason }
    }
    END { printf "tests: %d passed, %d failed, %d skipped\n", passed, failed, skipped }'
}

# run_tests <preset> <ctest argument>...: four in parallel for each processor, because many tests wait most of their
# time. A test of a suite that computes takes the place of three. The time limit of a test is that of the preset,
# multiplied for longer random tests (G4LIDAR_TEST_SCALE).
# ctest counts a skipped test as passed: the last line does not. Each skipped test has a line
# "SKIPPED: name: reason", each failed one a line "FAILED: name".
run_tests() {
  local preset=$1 scale=${G4LIDAR_TEST_SCALE:-1} longer=() code=0
  local results=$PWD/build/${preset%-all}/tests.xml
  shift
  if ((scale > 1)); then longer=(--timeout $((600 * scale))); fi
  # The seed of rapidcheck: fixed by default.
  export RC_PARAMS=${RC_PARAMS:-seed=${G4LIDAR_TEST_SEED:-1}}
  rm -f "$results"
  # All output is kept: the skipped tests of an executable are named in it.
  ctest --preset "$preset" --parallel "$((4 * $(nproc)))" --output-junit "$results" \
    --test-output-size-passed 10000000 "${longer[@]}" "$@" || code=$?
  if [[ -e $results ]]; then report_tests <"$results"; fi
  return "$code"
}
