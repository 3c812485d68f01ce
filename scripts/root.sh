# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# A minimal Debian 12 (bookworm) or 13 (trixie) below a directory, to test in a system without any
# file of this project. It is created once, as an archive in build, and unpacked for each use; after a
# week it is created again. Sourced by scripts that run as root; needs bash, and scripts/packages.sh
# sourced before.

debian_root=

# find_mirrors <release>: sets debian_sources, the lines for sources.list, and debian_mirror. The
# mirrors are those of this machine's apt for Debian 12 or 13.
find_mirrors() {
  # shellcheck disable=SC2016  # the dollars are apt's
  debian_sources=$(apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) main' 'Created-By: Packages' \
    | awk -v release="$1" '$3 ~ /^(bookworm|trixie)(-updates|-security)?$/ { sub(/^[a-z]+/, release, $3); print }' \
    | sort --unique)
  debian_mirror=$(awk -v release="$1" '$3 == release { print $2; exit }' <<<"$debian_sources")
  [[ $debian_mirror ]] || { echo "apt on this machine has no source for Debian 12 or 13" >&2; return 1; }
}

# make_root <release> [<package>...]: creates one below $debian_root, with these packages, the package
# mirrors and the name service of this machine, and its own pseudo-terminals; it is removed when the
# script ends.
make_root() {
  local release=$1 begin=$SECONDS archive=$PWD/build/debian-$1.tar
  shift
  if (($# > 0)); then archive=${archive%.tar}-$(cksum <<<"$*" | cut -d ' ' -f 1).tar; fi
  need_packages debootstrap git
  find_mirrors "$release"

  debian_root=$(mktemp -d -t g4lidar-clean-root.XXXXXX)
  trap remove_root EXIT
  mkdir -p build
  if [[ -n $(find "$archive" -mtime -7 2>/dev/null) ]]; then
    tar --extract --file "$archive" --directory "$debian_root" --same-permissions
    connect_root
  else
    echo "Making a minimal Debian ($release) ..."
    debootstrap --variant=minbase "$release" "$debian_root" "$debian_mirror" >"$debian_root.log" 2>&1 \
      || { tail -n 20 "$debian_root.log" >&2; return 1; }
    connect_root
    # shellcheck disable=SC2016  # the dollar is the other shell's
    (($# == 0)) || in_root env DEBIAN_FRONTEND=noninteractive bash -c 'apt-get update -qq &&
      apt-get install --yes -qq --no-install-recommends -o Dpkg::Use-Pty=0 "$@" && apt-get clean' install "$@" \
      >"$debian_root.log" 2>&1 || { tail -n 20 "$debian_root.log" >&2; return 1; }
    # Without the directories that debootstrap and connect_root have mounted.
    tar --create --file "$archive.new" --directory "$debian_root" --one-file-system --exclude='./proc/*' \
      --exclude='./sys/*' .
    mv "$archive.new" "$archive"
  fi
  echo "Made a minimal Debian ($release) in $((SECONDS - begin)) s"
}

# For scripts in the root, by `source /tmp/functions`. files: those of the root, without those of apt and the dynamic
# linker. wait_for <command>...: at most a minute. need_files <file>...: they exist, and have something in them.
files() {
  find / -xdev '(' -path /proc -o -path /dev -o -path /tmp -o -path /var/cache -o -path /var/lib/apt \
    -o -path /var/lib/dpkg -o -path /var/log -o -path /etc/ld.so.cache ')' -prune -o -print | sort
}
wait_for() {
  local i
  for ((i = 0; i < 600; ++i)); do
    if "$@" 2>/dev/null; then return; fi
    sleep 0.1
  done
  echo "not within a minute: $*" >&2
  return 1
}
need_files() (
  for each in "$@"; do test -s "$each" || { echo "$each is not there" >&2; exit 1; }; done
)
# runs <port>: whether g4-serve is there, and has a lidar that runs.
runs() (
  exec 3<>"/dev/tcp/127.0.0.1/$1" || exit
  printf 'GET /status.json HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n' >&3
  grep -q '"state":"running"' <&3
)

# connect_root: its apt, its pip and its name service reach the same servers as this machine.
connect_root() {
  chmod 755 "$debian_root" # as every root directory: mktemp gives it to one user
  echo "$debian_sources" >"$debian_root/etc/apt/sources.list"
  apt-config dump Acquire >"$debian_root/etc/apt/apt.conf.d/90acquire"
  local certificates setting
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
  declare -f files wait_for need_files runs >"$debian_root/tmp/functions"
}

remove_root() {
  local each
  for each in ccache dev/pts proc; do
    if mountpoint --quiet "$debian_root/$each"; then umount --lazy "$debian_root/$each" || return; fi
  done
  rm -rf --one-file-system "$debian_root" "$debian_root.log"
}

# in_root <command>...: runs it there, with an environment of its own.
in_root() {
  env --ignore-environment HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb LANG=C.UTF-8 \
    ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} \
    ${DEB_BUILD_OPTIONS:+"DEB_BUILD_OPTIONS=$DEB_BUILD_OPTIONS"} \
    ${G4LIDAR_TEST_SCALE:+"G4LIDAR_TEST_SCALE=$G4LIDAR_TEST_SCALE"} \
    ${G4LIDAR_TEST_SEED:+"G4LIDAR_TEST_SEED=$G4LIDAR_TEST_SEED"} \
    chroot "$debian_root" "$@"
}

# answer_apt: its apt asks nothing.
answer_apt() {
  printf '%s\n' 'APT::Install-Recommends "false";' 'APT::Get::Assume-Yes "true";' 'Acquire::Retries "3";' 'quiet "2";' \
    'Dpkg::Use-Pty "0";' 'Acquire::http::Proxy::127.0.0.1 "DIRECT";' >"$debian_root/etc/apt/apt.conf.d/91answers"
}
