# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The Debian packages that the scripts need, in one place, and their installation.
# Sourced by the scripts; needs bash.

# To build the library and g4-dump. make is sufficient if it is installed and Ninja is not.
packages_demo=(
  "$(if command -v make >/dev/null && ! command -v ninja >/dev/null; then echo make; else echo ninja-build; fi)"
  cmake g++ pkg-config libudev-dev libexpected-dev
  libcli11-dev libfmt-dev libncurses-dev libzstd-dev nlohmann-json3-dev zlib1g-dev
)

# To build all programs.
packages_programs=("${packages_demo[@]}" libboost-dev cyclonedds-dev cyclonedds-tools)

# To build the tests.
packages_test=(
  "${packages_programs[@]}"
  binutils libeigen3-dev libgmock-dev libgtest-dev python3-pyte tmux librapidcheck-dev libumockdev-dev ninja-build umockdev
)

# To build and run the benchmarks.
packages_bench=(
  "${packages_demo[@]}"
  libbenchmark-dev ninja-build python3-minimal strace valgrind
)

# To build the Debian packages.
packages_package=(
  "${packages_programs[@]}"
  build-essential debhelper doxygen dpkg-dev git libeigen3-dev libgmock-dev libgtest-dev librapidcheck-dev ninja-build
)

# To make maps: scripts/slam.
# shellcheck disable=SC2034
packages_slam=(mrpt-apps python3-venv)

# To build in a workspace of ROS: scripts/ci/colcon.
# shellcheck disable=SC2034
packages_colcon=(colcon python3-colcon-cmake python3-colcon-package-information python3-colcon-ros)

# To compile and run packages of ROS 2 with the installations for Debian 12: scripts/ros.sh.
# shellcheck disable=SC2034
packages_ros=(
  libyaml-0-2 libconsole-bridge1.0 libddsc0debian libfastcdr1 libfastrtps2.9 libfoonathan-memory0.7.2
  libtinyxml2-9 libssl3 libpython3.11 python3 python3-yaml python3-numpy python3-lark python3-packaging
  python3-importlib-metadata python3-argcomplete python3-netifaces python3-psutil python3-pkg-resources
  g++ make cmake ninja-build libyaml-dev libconsole-bridge-dev libeigen3-dev python3-empy python3-setuptools
  python3-distutils python3-catkin-pkg libpython3-dev libfastrtps-dev libfoonathan-memory-dev libtinyxml2-dev
  libssl-dev python3-dev python3-pytest libgtest-dev
  colcon python3-colcon-ros python3-colcon-cmake python3-colcon-bash python3-colcon-recursive-crawl
  python3-colcon-package-selection python3-colcon-package-information python3-colcon-output
  python3-colcon-parallel-executor python3-colcon-library-path python3-colcon-metadata
  python3-colcon-test-result python3-colcon-defaults
)

# To test the page of g4-serve in a browser, and to make pictures of it.
packages_browser=(chromium chromium-driver fonts-dejavu-core python3-selenium)

# The contents of a sysroot for cross-building, in the architecture of the target: see
# scripts/sysroot.
# shellcheck disable=SC2034
packages_sysroot=(
  libc6-dev libudev-dev libexpected-dev libcli11-dev libfmt-dev nlohmann-json3-dev libzstd-dev zlib1g-dev
)

# What is linked into the portable archives, and how they are made and tried: scripts/release, scripts/ci/portable.
# shellcheck disable=SC2034
packages_portable=(
  libudev-dev libexpected-dev libcli11-dev libfmt-dev nlohmann-json3-dev libzstd-dev zlib1g-dev libncurses-dev
  libboost1.81-dev libgcc-s1
)
# shellcheck disable=SC2034
packages_release=(binutils ccache cmake debootstrap git gpg gpg-agent gpgconf ninja-build python3-dev python3-venv reprepro)

# Everything that .ci/run needs.
# shellcheck disable=SC2034
packages_ci=(
  "${packages_test[@]}" "${packages_bench[@]}" "${packages_package[@]}" "${packages_browser[@]}"
  ccache debootstrap git lintian pkg-config shellcheck valgrind
  g++-11 python3-dev python3-venv
  clang-19 clang-format-19 clang-tidy-19 libclang-rt-19-dev
  googletest qemu-user-static
  fish mandoc zsh
  g++-s390x-linux-gnu g++-aarch64-linux-gnu g++-arm-linux-gnueabihf
  gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm
  abigail-tools
  iproute2
)

# need_packages <package>...: installs the missing ones without questions and prints what it
# installs. Takes a few hundredths of a second if all are installed.
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
    echo "Missing packages: ${missing[*]}; this script installs them with apt-get of Debian only." >&2
    echo "On other systems install the equivalent packages, and build with CMake as described in docs/install.md." >&2
    return 1
  fi

  echo "Installing ${#missing[@]} packages: ${missing[*]}"
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
    apt-get install --yes --no-install-recommends -qq -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
  # On a terminal sudo may ask for a password; elsewhere there are lines while it takes time.
  if [[ ! -t 1 ]] && declare -F run_quietly >/dev/null; then
    run_quietly "Installing them" install_missing
  else
    install_missing
  fi
}

# install_missing: a part of need_packages, with its variables. Existing package lists are used first,
# which saves the update; outdated ones fail immediately.
install_missing() {
  if "${install[@]}" --print-uris "${missing[@]}" >/dev/null 2>&1 \
    && "${install[@]}" "${missing[@]}" >/dev/null 2>&1; then
    return 0
  fi
  "${as_root[@]}" apt-get update -qq -o Acquire::Retries=3 && "${install[@]}" "${missing[@]}" >/dev/null
}

# missing_packages <package>...: those that are not installed, one per line.
missing_packages() {
  dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null \
    | awk -v wanted="$*" '
        $2 == "installed" { have[$1] = 1 }
        END {
          count = split(wanted, names, " ")
          for (i = 1; i <= count; ++i) if (!(names[i] in have)) print names[i]
        }'
}
