# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The Debian packages that the scripts need, in one place, and how they are installed.
# Sourced by the scripts; needs bash.

# What it takes to build the library and g4-dump.
packages_demo=(
  cmake g++ ninja-build pkg-config libudev-dev libexpected-dev
  libcli11-dev libfmt-dev libzstd-dev nlohmann-json3-dev
)

# And the tests.
packages_test=(
  "${packages_demo[@]}"
  binutils libeigen3-dev libgmock-dev libgtest-dev librapidcheck-dev libumockdev-dev umockdev
)

# What it takes to build and run the benchmarks.
packages_bench=(
  "${packages_demo[@]}"
  libbenchmark-dev python3-minimal strace valgrind
)

# What it takes to build the Debian packages.
packages_package=(
  "${packages_demo[@]}"
  debhelper dpkg-dev git libeigen3-dev libgmock-dev libgtest-dev librapidcheck-dev
)

# What a sysroot for cross-building is made of, in the target's architecture: see scripts/sysroot.
# shellcheck disable=SC2034
packages_sysroot=(
  libc6-dev libudev-dev libexpected-dev libcli11-dev libfmt-dev nlohmann-json3-dev libzstd-dev
)

# And everything that .ci/run does.
# shellcheck disable=SC2034
packages_ci=(
  "${packages_test[@]}" "${packages_bench[@]}" "${packages_package[@]}"
  ccache debootstrap doxygen git lintian pkg-config shellcheck valgrind
  g++-11 python3-venv
  clang-19 clang-format-19 clang-tidy-19 libclang-rt-19-dev
  googletest qemu-user-static
  fish mandoc zsh
  g++-s390x-linux-gnu g++-aarch64-linux-gnu g++-arm-linux-gnueabihf
  gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm
)

# need_packages <package>...: installs those that are missing; asks nothing and says what it does.
# Takes a few hundredths of a second when all are there.
need_packages() {
  local missing=()
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    return 0
  fi

  local as_root=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "These Debian packages are missing: ${missing[*]}" >&2
      echo "Install them as root, or install sudo, and run this again:" >&2
      echo "  apt-get update && apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  if ! command -v apt-get >/dev/null; then
    echo "This needs Debian's apt-get to install: ${missing[*]}" >&2
    echo "Elsewhere install their equivalents, and build with CMake as the README shows." >&2
    return 1
  fi

  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
    apt-get install --yes --no-install-recommends -qq -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
  # With lists that are there and fresh enough the update is saved; stale ones fail at once.
  if "${install[@]}" --print-uris "${missing[@]}" >/dev/null 2>&1 \
    && "${install[@]}" "${missing[@]}" >/dev/null 2>&1; then
    return 0
  fi
  "${as_root[@]}" apt-get update -qq -o Acquire::Retries=3
  "${install[@]}" "${missing[@]}" >/dev/null
}

# missing_packages <package>...: those of them that are not installed, one a line.
missing_packages() {
  dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null \
    | awk -v wanted="$*" '
        $2 == "installed" { have[$1] = 1 }
        END {
          count = split(wanted, names, " ")
          for (i = 1; i <= count; ++i) if (!(names[i] in have)) print names[i]
        }'
}
