# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Makes the Debian packages of the last commit for Debian 12 and 13, amd64 and arm64, and a signed tree of them for apt.
# Sourced by scripts/release and scripts/package, after scripts/packages.sh and scripts/build.sh; needs bash.

# package_source <directory> [--final]: the last commit there, as dpkg-buildpackage reads it; sets package_version.
# Between releases the version has the number of commits and the commit, so that apt upgrades to a newer build.
package_source() {
  local built released parts
  released=$(sed -n '1s/.*(\(.*\)).*/\1/p' debian/changelog)
  parts=$(sed -n 's/^#define G4LIDAR_VERSION_[A-Z]* //p' include/g4lidar/version.hpp | paste -s -d .)
  if [[ $released != "$parts" ]]; then
    echo "debian/changelog has version $released, include/g4lidar/version.hpp has $parts" >&2
    return 1
  fi
  built=$(cmake/version.sh "${@:2}")
  package_version=${built%% *}
  mkdir -p "$1"
  git archive HEAD | tar -x -C "$1"
  echo "$built" >"$1/build-version"
  if [[ $package_version != "$released" ]]; then add_changelog "$1" "$package_version" "A build between releases."; fi
}

# add_changelog <directory> <version> <text>: an entry of that version in its debian/changelog.
add_changelog() {
  local maintainer
  maintainer=$(sed -n 's/^Maintainer: //p' "$1/debian/control")
  {
    printf 'libg4lidar (%s) unstable; urgency=medium\n\n  * %s\n\n' "$2" "$3"
    printf ' -- %s  %s\n\n' "$maintainer" "$(TZ=UTC git log -1 --date=rfc-local --format=%cd)"
    cat "$1/debian/changelog"
  } >"$1/changelog.new"
  mv "$1/changelog.new" "$1/debian/changelog"
}

# find_cache: debhelper sets another home directory, where no cache would persist.
find_cache() {
  if command -v ccache >/dev/null; then CCACHE_DIR=$(ccache --get-config cache_dir); fi
  export CCACHE_DIR PATH=/usr/lib/ccache:$PATH
}

# build_packages <release> <directory> <profiles> [--final]: those of both processors, in a root of that release. arm64
# is compiled here and not run; an emulator runs the programs that write their man pages. A release after the first one
# makes only g4lidar-ros2.
build_packages() (
  find_cache
  make_root "$1" build-essential ccache crossbuild-essential-arm64 debhelper qemu-user-static
  mkdir -p "$debian_root/build" "$debian_root/ccache" "$CCACHE_DIR"
  mount --bind "$CCACHE_DIR" "$debian_root/ccache"
  package_source "$debian_root/build/libg4lidar" "${@:4}"
  if [[ $1 == trixie ]]; then add_changelog "$debian_root/build/libg4lidar" "$package_version~deb13" "For Debian 13."; fi
  export DEB_BUILD_OPTIONS="nocheck noautodbgsym terse parallel=$(nproc)"
  for architecture in amd64 arm64; do
    run_quietly "Building for Debian ($1) and $architecture" \
      in_root bash -euo pipefail -s "$architecture" "nocheck$3$(if [[ $architecture == arm64 ]]; then echo ,cross; fi)" <<'IN_ROOT'
export CCACHE_DIR=/ccache CCACHE_DEPEND=1 CCACHE_NOHASHDIR=1 CCACHE_BASEDIR=/build/libg4lidar DEBIAN_FRONTEND=noninteractive
dpkg --add-architecture "$1"
apt-get update -qq
apt-get build-dep --yes -qq --no-install-recommends --host-architecture "$1" --build-profiles "$2" /build/libg4lidar
cd /build/libg4lidar
PATH=/usr/lib/ccache:$PATH dpkg-buildpackage --no-sign --build=binary --host-arch "$1" --build-profiles="$2"
IN_ROOT
  done
  cp "$debian_root"/build/*.deb "$2"
)

# make_key <directory>: a directory of gpg with the key that signs, and its fingerprint in signing_key.
make_key() {
  export GNUPGHOME=$1
  mkdir -m 700 "$GNUPGHOME"
  if [[ ${G4LIDAR_SIGNING_KEY:-} ]]; then
    gpg --batch --quiet --import "$G4LIDAR_SIGNING_KEY"
  else
    echo "G4LIDAR_SIGNING_KEY names no file with a secret key: a new key signs the tree. It is for tests alone, and is lost."
    gpg --batch --quiet --passphrase '' --quick-generate-key 'libg4lidar, a key for tests' ed25519 sign never
  fi
  signing_key=$(gpg --batch --list-secret-keys --with-colons | awk -F: '$1 == "fpr" { print $10; exit }')
}

# make_apt <directory> [--final]: the tree of both releases in its directory apt, and the public key in apt/g4lidar.asc.
make_apt() {
  local scratch tree=$1/apt release codenames=(bookworm trixie)
  scratch=$(mktemp -d -t g4lidar-apt.XXXXXX)
  mkdir -p "$scratch/bookworm" "$scratch/trixie" "$scratch/conf"
  build_packages bookworm "$scratch/bookworm" '' "${@:2}"
  build_packages trixie "$scratch/trixie" ,pkg.libg4lidar.ros2 "${@:2}"
  make_key "$scratch/gnupg"
  for release in "${codenames[@]}"; do
    printf '%s\n' 'Origin: libg4lidar' 'Label: libg4lidar' "Codename: $release" 'Architectures: amd64 arm64' \
      'Components: main' "SignWith: $signing_key" ''
  done >"$scratch/conf/distributions"
  rm -rf "$tree"
  mkdir -p "$tree"
  gpg --batch --armor --export "$signing_key" >"$tree/g4lidar.asc"
  for release in "${codenames[@]}"; do
    find "$scratch/bookworm" "$scratch/$release" -name '*.deb' \( -path "$scratch/$release/*" -o -not -name 'g4lidar-ros2_*' \) \
      -exec reprepro --silent --silent --basedir "$scratch" --outdir "$tree" includedeb "$release" {} +
  done
  gpgconf --kill all
  rm -rf "$scratch"
}
