#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints the version of this tree in one line: as dpkg compares it, as pip does, the date and the commit; of a release
# (--final) the first two are plain numbers; without history, too, and the others are "-".
# include/g4lidar/version.hpp has that of the newest release. Between releases the number of commits comes first, so
# that versions sort:
#   0.1.1~dev869+gabcdef0 0.1.1.dev869 2026-11-28 abcdef0
# A source archive has this line in the file build-version; one of pip has its version in PKG-INFO.
set -eu
cd "$(dirname "$0")/.."

if [ -e build-version ]; then exec cat build-version; fi
number=$(sed -n 's/^#define G4LIDAR_VERSION_[A-Z]* //p' include/g4lidar/version.hpp | paste -s -d .)
if [ -e PKG-INFO ]; then
  pip=$(sed -n '/^$/q; s/^Version: //p' PKG-INFO)
  echo "$(echo "$pip" | sed 's/\.dev/~dev/') $pip - -"
elif [ -e .git ] && commit=$(git rev-parse --short=7 HEAD 2>/dev/null) \
  && { [ "${1:-}" = --final ] || [ "$(git rev-parse --is-shallow-repository)" = false ]; }; then
  count=$(git rev-list --count HEAD)
  next=${number%.*}.$((${number##*.} + 1))
  versions="$next~dev$count+g$commit $next.dev$count"
  if [ "${1:-}" = --final ]; then versions="$number $number"; fi
  echo "$versions $(TZ=UTC git log -1 --date=format-local:%Y-%m-%d --format=%cd) $commit"
else
  echo "$number $number - -"
fi
