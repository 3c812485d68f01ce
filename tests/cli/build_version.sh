#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The version of a tree (cmake/version.sh): between releases with the number of commits and the commit; of a source
# archive, of one of pip, and without history. What scripts/release --final refuses. Needs G4LIDAR_SOURCE_DIR.
set -euo pipefail
command -v git >/dev/null || { echo "SKIPPED: git is missing"; exit 0; }
unset GIT_DIR GIT_WORK_TREE
export GIT_CONFIG_GLOBAL=/dev/null GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a@example.org GIT_COMMITTER_NAME=a
export GIT_COMMITTER_EMAIL=a@example.org GIT_COMMITTER_DATE='2026-01-01T01:30:00+0200'
rm -rf tree
mkdir -p tree/include/g4lidar tree/cmake
cp "$G4LIDAR_SOURCE_DIR"/cmake/{version.sh,build_version.cmake} tree/cmake
cp -r "$G4LIDAR_SOURCE_DIR/scripts" tree
printf '#define G4LIDAR_VERSION_%s\n' 'MAJOR 1' 'MINOR 4' 'PATCH 9' >tree/include/g4lidar/version.hpp
printf '# Changelog\n\n## [Unreleased]\n\n## [1.4.8]\n' >tree/CHANGELOG.md

# expect <what> <text> <extended regular expression>
expect() {
  [[ $2 =~ ^$3$ ]] || { echo "$1: '$2' does not match $3" >&2; exit 1; }
}
plain='1\.4\.9 1\.4\.9 - -'
expect "without git" "$(tree/cmake/version.sh)" "$plain"
git -C tree init --quiet
git -C tree add .
for each in 1 2 3; do git -C tree commit --quiet --allow-empty -m "$each"; done
commit=$(git -C tree rev-parse --short=7 HEAD)
dev="1\.4\.10~dev3\+g$commit 1\.4\.10\.dev3 2025-12-31 $commit"
expect "three commits" "$(tree/cmake/version.sh)" "$dev"
expect "a release" "$(tree/cmake/version.sh --final)" "1\.4\.9 1\.4\.9 2025-12-31 $commit"
git clone --quiet --depth 1 "file://$PWD/tree" shallow 2>/dev/null
expect "a clone without history" "$(shallow/cmake/version.sh)" "$plain"
rm -rf shallow

# The source changes with the version alone.
cmake -DTO="$PWD/version.cpp" -P tree/cmake/build_version.cmake
grep -qF "= \"1.4.10~dev3+g$commit (2025-12-31)\";" version.cpp
touch -d '2020-01-01' version.cpp
cmake -DTO="$PWD/version.cpp" -P tree/cmake/build_version.cmake
[[ $(date -r version.cpp +%Y) == 2020 ]] || { echo "an equal version is written again" >&2; exit 1; }

# refuse <expected message> <part>: scripts/release --final.
refuse() {
  if PYTHONS=none G4LIDAR_SIGNING_KEY='' tree/scripts/release --final "$2" >release.txt 2>&1; then
    echo "scripts/release --final is not refused: $1" >&2
    exit 1
  fi
  grep -qF "$1" release.txt || { echo "not refused with '$1': $(<release.txt)" >&2; exit 1; }
}
refuse "CHANGELOG.md has no entry '## [1.4.9]'" --source
echo "## [1.4.9]" >>tree/CHANGELOG.md
refuse "not committed" --source
echo 'need_packages() { :; }' >>tree/scripts/packages.sh
git -C tree commit --quiet --all -m "An entry"
refuse "G4LIDAR_SIGNING_KEY names no file" --apt
refuse "the wheels need Python 3.10" --wheels
[[ ! -e tree/dist ]] || { echo "something is made before it is refused" >&2; exit 1; }

echo "1.4.9 1.4.9 2026-02-03 0123456" >tree/build-version
expect "a source archive" "$(tree/cmake/version.sh)" "1\.4\.9 1\.4\.9 2026-02-03 0123456"
cmake -DTO="$PWD/version.cpp" -P tree/cmake/build_version.cmake
grep -qF '= "1.4.9";' version.cpp
rm tree/build-version
printf 'Name: g4lidar\nVersion: 1.4.10.dev3\n\nVersion: none\n' >tree/PKG-INFO
expect "an archive of pip" "$(tree/cmake/version.sh)" '1\.4\.10~dev3 1\.4\.10\.dev3 - -'
