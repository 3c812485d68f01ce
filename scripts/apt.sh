# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Makes the source archive of the last commit, of it the Debian packages for Debian 12 and 13, amd64 and arm64, and a
# signed tree of them for apt.
# Sourced by scripts/release, after scripts/{packages,build,root}.sh, and by scripts/package; needs bash.

# make_source <directory> [--final]: the source archive; sets `archive`, its file, and `version`.
make_source() {
  mkdir -p "$1"
  cmake/version.sh "${@:2}" >"$1/build-version"
  read -r version _ <"$1/build-version"
  archive=$1/libg4lidar-$version.tar.gz
  git archive --prefix="libg4lidar-$version/" --add-file="$1/build-version" HEAD | gzip -n9 >"$archive"
}

# package_source <directory> <suffix> <archive>: what the archive has, as dpkg-buildpackage reads it; sets
# package_version, which ends in that suffix. Between releases it has the number of commits and the commit, so that
# apt upgrades to a newer build.
package_source() {
  local released parts
  mkdir -p "$1"
  tar -xzf "$3" -C "$1" --strip-components=1
  released=$(sed -n '1s/.*(\(.*\)).*/\1/p' "$1/debian/changelog")
  parts=$(sed -n 's/^#define G4LIDAR_VERSION_[A-Z]* //p' "$1/include/g4lidar/version.hpp" | paste -s -d .)
  [[ $released == "$parts" ]] \
    || { echo "debian/changelog has version $released, include/g4lidar/version.hpp has $parts" >&2; return 1; }
  package_version=$(cut -d ' ' -f 1 "$1/build-version")$2
  if [[ $package_version != "$released" ]]; then
    {
      printf 'libg4lidar (%s) unstable; urgency=medium\n\n  * A build of this version.\n\n' "$package_version"
      sed -n 's/^Maintainer: \(.*\)/ -- \1  /p' "$1/debian/control" | tr -d '\n'
      TZ=UTC date --rfc-email --reference "$1/debian/control" # the date of the commit
      echo
      cat "$1/debian/changelog"
    } >"$1/changelog"
    mv "$1/changelog" "$1/debian/changelog"
  fi
}

# find_cache: debhelper sets another home directory, where no cache would persist.
find_cache() {
  if ! command -v ccache >/dev/null; then return; fi
  CCACHE_DIR=$(ccache --get-config cache_dir)
  export CCACHE_DIR CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
}

# build_packages <release> <suffix> <directory> <profile> <archive>: those of both processors, or of `architectures`,
# in a root of that release. arm64 is cross-built; an emulator runs the programs where they write their man pages.
build_packages() (
  find_cache
  make_root "$1" build-essential ccache crossbuild-essential-arm64 debhelper qemu-user-static
  # shellcheck disable=SC2154  # of scripts/root.sh
  mkdir -p "$debian_root/build" "$debian_root/ccache" "$CCACHE_DIR"
  mount --bind "$CCACHE_DIR" "$debian_root/ccache"
  package_source "$debian_root/build/libg4lidar" "$2" "$5"
  for architecture in ${architectures:-amd64 arm64}; do
    run_quietly "Building for Debian ($1) and $architecture" \
      in_root env DEB_BUILD_OPTIONS="nocheck noautodbgsym terse parallel=$(nproc)" \
      bash -euo pipefail -s "$architecture" "nocheck${4:+,$4}" <<'IN_ROOT'
export DEBIAN_FRONTEND=noninteractive CCACHE_DIR=/ccache CCACHE_DEPEND=1 CCACHE_NOHASHDIR=1
export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
dpkg --add-architecture "$1"
apt-get update -qq
apt-get build-dep --yes -qq --no-install-recommends --host-architecture "$1" --build-profiles "$2" /build/libg4lidar
cd /build/libg4lidar
dpkg-buildpackage --no-sign --build=binary --host-arch "$1" --build-profiles="$2"
IN_ROOT
  done
  cp "$debian_root"/build/*.deb "$3"
)

# make_apt <directory> <archive>: the tree of both releases in its directory apt, and the public key in apt/g4lidar.asc.
make_apt() (
  local scratch tree=$1/apt key release
  scratch=$(mktemp -d -t g4lidar-apt.XXXXXX)
  trap 'gpgconf --kill all; rm -rf "$scratch"' EXIT # it has the secret key
  mkdir -p "$scratch"/{bookworm,trixie,conf}
  mkdir -m 700 "$scratch/gnupg"
  local -x GNUPGHOME=$scratch/gnupg
  if [[ ${G4LIDAR_SIGNING_KEY:-} ]]; then
    gpg --batch --quiet --import "$G4LIDAR_SIGNING_KEY"
  else
    echo "G4LIDAR_SIGNING_KEY names no file with a secret key: a new key signs the tree, which is for tests alone"
    gpg --batch --quiet --passphrase '' --quick-generate-key 'libg4lidar, a key for tests' ed25519 sign never
  fi
  key=$(gpg --batch --list-secret-keys --with-colons | awk -F: '$1 == "fpr" { print $10; exit }')
  [[ $key ]] || { echo "$G4LIDAR_SIGNING_KEY has no secret key" >&2; return 1; }
  build_packages bookworm "" "$scratch/bookworm" "" "$2"
  build_packages trixie "~deb13" "$scratch/trixie" pkg.libg4lidar.ros2 "$2" # all others are those of Debian 12
  for release in bookworm trixie; do
    printf '%s\n' 'Origin: libg4lidar' 'Label: libg4lidar' "Codename: $release" 'Architectures: amd64 arm64' \
      'Components: main' "SignWith: $key" ''
  done >"$scratch/conf/distributions"
  rm -rf "$tree"
  mkdir -p "$tree"
  gpg --batch --armor --export "$key" >"$tree/g4lidar.asc"
  local include=(reprepro --silent --silent --basedir "$scratch" --outdir "$tree" includedeb)
  "${include[@]}" bookworm "$scratch"/bookworm/*.deb
  rm "$scratch"/bookworm/g4lidar-ros2_*
  "${include[@]}" trixie "$scratch"/{bookworm,trixie}/*.deb
)
