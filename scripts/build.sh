# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# How the scripts configure and build: quietly when all is well, with everything when it is not.
# Sourced by the scripts; needs bash.

# run_quietly <what> <command>...: prints one line, and the command's output only if it fails.
run_quietly() {
  local what=$1 output
  shift
  printf '%s ... ' "$what"
  local begin=$SECONDS
  if output=$("$@" 2>&1); then
    printf '%d s\n' "$((SECONDS - begin))"
  else
    local code=$?
    printf 'failed\n%s\n' "$output" >&2
    return "$code"
  fi
}

# ccache asks the compiler itself what a source included, which saves its first run over each; it
# takes precompiled headers; and two build directories may share what is compiled the same.
export CCACHE_DEPEND=${CCACHE_DEPEND:-1}
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
export CCACHE_NOHASHDIR=${CCACHE_NOHASHDIR:-1}

# configure <build directory> <cmake argument>...
configure() {
  local directory=$1
  shift
  local launcher=()
  if command -v ccache >/dev/null; then
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  run_quietly "Configuring $directory" cmake -S . -B "$directory" -G Ninja "${launcher[@]}" "$@"
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
  run_quietly "Building $directory" cmake --build "$directory" "${targets[@]}" -- --quiet
}

# run_tests <preset> <ctest argument>...: as many at once as there are processors. The time that one
# may take is the preset's; where the random ones are longer (G4LIDAR_TEST_SCALE), so is it.
run_tests() {
  local preset=$1 scale=${G4LIDAR_TEST_SCALE:-1} longer=()
  shift
  if ((scale > 1)); then longer=(--timeout $((600 * scale))); fi
  ctest --preset "$preset" --parallel "$(nproc)" "${longer[@]}" "$@"
}
