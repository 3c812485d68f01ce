# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Finds an installation of ROS 2 for the checks that use a real one. Sourced by the scripts; needs bash and packages.sh.

# find_ros <release>: whether /opt/ros/<release> is there. If it is not, unpacks the archive that lies beside the
# project, if there is one for this system. Prints the reason if there is none.
find_ros() {
  local release=$1 archive
  archive=../shared/ros2/ros2-$release-bookworm-$(dpkg --print-architecture 2>/dev/null || true).tar.zst
  exec {ros_lock}>"/tmp/g4lidar-ros-$UID.lock"
  flock "$ros_lock"
  if [[ ! -e /opt/ros/$release/setup.bash && -e $archive && $EUID == 0 ]] \
    && grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then
    need_packages zstd
    run_quietly "Unpacking ROS 2 $release" tar -C / --zstd -xf "$archive"
  fi
  exec {ros_lock}>&-
  if [[ ! -e /opt/ros/$release/setup.bash ]]; then
    echo "SKIPPED: ROS 2 $release is not installed in /opt/ros/$release"
    return 1
  fi
  # shellcheck disable=SC2154  # of packages.sh
  if grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then need_packages "${packages_ros[@]}"; fi
}

# in_ros <release> <command>...: the command with the environment of this release, and the Python of the system.
in_ros() {
  (
    PATH=/usr/bin:/bin:/usr/sbin:/sbin
    set +u
    # shellcheck disable=SC1090
    source "/opt/ros/$1/setup.bash"
    set -u
    "${@:2}"
  )
}
