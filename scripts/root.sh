# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# A minimal Debian 12 below a directory, to test in a system without any file of this project. It is
# created once, as the archive build/debian-12.tar, and unpacked for each use; after a week it is
# created again. Sourced by scripts that run as root; needs bash, and scripts/packages.sh sourced
# before.

debian_release=bookworm
debian_root=

# make_root: creates one below $debian_root, with the package sources and the name service of this
# machine and its own pseudo-terminals; it is removed when the script ends.
make_root() {
  need_packages debootstrap git
  # The mirrors are those of this machine's apt for Debian 12.
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
  local archive=$PWD/build/debian-12.tar
  mkdir -p build
  if [[ -z $(find "$archive" -mtime -7 2>/dev/null) ]]; then
    echo "Making a minimal Debian 12 ..."
    if ! debootstrap --variant=minbase "$debian_release" "$debian_root" "$mirror" >"$debian_root.log" 2>&1; then
      tail -n 20 "$debian_root.log" >&2
      return 1
    fi
    # Without the directories that debootstrap has mounted.
    tar --create --file "$archive.new" --directory "$debian_root" --one-file-system --exclude='./proc/*' \
      --exclude='./sys/*' .
    mv "$archive.new" "$archive"
  else
    tar --extract --file "$archive" --directory "$debian_root" --same-permissions
  fi
  chmod 755 "$debian_root" # as every root directory: mktemp gives it to one user
  echo "Made a minimal Debian 12 in $((SECONDS - begin)) s"

  # Its apt, its pip and its name service reach the same servers as this machine.
  echo "$sources" >"$debian_root/etc/apt/sources.list"
  apt-config dump Acquire >"$debian_root/etc/apt/apt.conf.d/90acquire"
  local certificates
  certificates=$(sed -n 's/^cert *= *//p' /etc/pip.conf 2>/dev/null || true)
  if [[ -e $certificates ]]; then
    cp --dereference "$certificates" "$debian_root/etc/pip.crt"
    printf '[global]\ncert = /etc/pip.crt\n' >"$debian_root/etc/pip.conf"
  fi
  for setting in /etc/resolv.conf /etc/hosts; do
    if [[ -e $setting ]]; then cp --dereference "$setting" "$debian_root$setting"; fi
  done
  if ! mountpoint --quiet "$debian_root/proc"; then mount -t proc proc "$debian_root/proc"; fi
  # Pseudo-terminals of its own, for the simulated G4.
  mount -t devpts -o newinstance,gid=5,ptmxmode=666,mode=620 devpts "$debian_root/dev/pts"
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
    ${G4LIDAR_TEST_SEED:+"G4LIDAR_TEST_SEED=$G4LIDAR_TEST_SEED"} \
    chroot "$debian_root" "$@"
}
