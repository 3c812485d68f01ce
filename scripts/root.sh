# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# A minimal Debian 12 below a directory, to see what happens in a system that has nothing of ours.
# Sourced by scripts that run as root; needs bash, and scripts/packages.sh sourced before.

debian_release=bookworm
debian_root=

# make_root: makes one below $debian_root, with this machine's sources of packages, name service and
# pseudo-terminals of its own; it is removed when the script ends.
make_root() {
  need_packages debootstrap git
  # The mirrors are whichever this machine's apt has for Debian 12 itself.
  local sources mirror begin=$SECONDS setting
  # shellcheck disable=SC2016  # the dollars are apt's
  sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) main' 'Created-By: Packages' \
    | grep -E " $debian_release(-updates|-security)? main$" | sort --unique || true)
  mirror=$(awk -v release="$debian_release" '$3 == release { print $2; exit }' <<<"$sources")
  if [[ -z $mirror ]]; then
    echo "apt on this machine has no source for Debian 12 ($debian_release) to make a root from" >&2
    return 1
  fi

  debian_root=$(mktemp -d -t g4lidar-clean-root.XXXXXX)
  trap remove_root EXIT
  echo "Making a minimal Debian 12 ..."
  if ! debootstrap --variant=minbase "$debian_release" "$debian_root" "$mirror" >"$debian_root.log" 2>&1; then
    tail -n 20 "$debian_root.log" >&2
    return 1
  fi
  echo "Made after $((SECONDS - begin)) s"

  # Its apt and its name service reach what this machine's do.
  echo "$sources" >"$debian_root/etc/apt/sources.list"
  apt-config dump Acquire >"$debian_root/etc/apt/apt.conf.d/90acquire"
  for setting in /etc/resolv.conf /etc/hosts; do
    if [[ -e $setting ]]; then cp --dereference "$setting" "$debian_root$setting"; fi
  done
  if ! mountpoint --quiet "$debian_root/proc"; then mount -t proc proc "$debian_root/proc"; fi
  # Pseudo-terminals of its own, for the simulated G4.
  mount -t devpts -o newinstance,ptmxmode=666,mode=620 devpts "$debian_root/dev/pts"
  ln -sf pts/ptmx "$debian_root/dev/ptmx"
}

remove_root() {
  local each
  for each in dev/pts proc; do
    if mountpoint --quiet "$debian_root/$each"; then umount --lazy "$debian_root/$each"; fi
  done
  rm -rf --one-file-system "$debian_root" "$debian_root.log"
}

# in_root <command>...: runs it there, with an environment of its own.
in_root() {
  env --ignore-environment HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb LANG=C.UTF-8 \
    ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} \
    ${G4LIDAR_TEST_SCALE:+"G4LIDAR_TEST_SCALE=$G4LIDAR_TEST_SCALE"} \
    chroot "$debian_root" "$@"
}
