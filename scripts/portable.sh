# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Makes the archives of programs that run on every Linux with glibc 2.28. The compiler is zig, which is a package of
# Python and has the C libraries and libc++ in it. Sourced by scripts/release; needs bash.

zig_version=0.17.1
work=$PWD/build/portable
glibc=2.28

# make_compiler <processor> <directory>: compilers for that processor there. zig has the baud rates of glibc 2.42, which
# are numbers; an older glibc returns codes: include/termios.h.
make_compiler() {
  local target=$1-linux-gnu python=$work/zig/bin/python tool
  fetch "$work/zig" python3 "ziglang==$zig_version"
  mkdir -p "$2/include"
  {
    echo '#include_next <termios.h>'
    sed -n 's/^#define *__\(B[0-9][0-9]*\)[ \t].*/#undef \1\n#define \1 __\1/p' \
      "$work"/zig/lib/python*/site-packages/ziglang/lib/libc/include/generic-glibc/bits/termios{,-cbaud}.h
  } >"$2/include/termios.h"
  grep -q '__B230400' "$2/include/termios.h"
  # ccache recognises clang by its name.
  for tool in clang:cc clang++:c++ ar:ar ranlib:ranlib; do
    {
      echo '#!/bin/sh'
      case $tool in
        clang*) echo "exec '$python' -m ziglang ${tool#*:} -target $target.$glibc \"\$@\"" ;;
        *) echo "exec '$python' -m ziglang ${tool#*:} \"\$@\"" ;;
      esac
    } >"$2/${tool%:*}"
    chmod +x "$2/${tool%:*}"
  done
}

# unpack_source <archive>: into $work/source; unchanged files keep their times.
unpack_source() {
  rm -rf "$work/source.new"
  mkdir -p "$work/source.new" "$work/source"
  tar --extract --gzip --file "$1" --directory "$work/source.new" --strip-components 1
  mv "$work/source/build" "$work/source.new/build" 2>/dev/null || true
  rm -rf "$work/source"
  mv "$work/source.new" "$work/source"
}

# set_options <processor>: sets `options`, those of CMake to compile for that processor with zig and these libraries.
# The module of Python exports one name, so that no function of another library replaces one of its own; it has the
# unwinder of GCC, as Python has where it ends threads.
set_options() {
  local processor=$1 build=$work/$1 inputs=$PWD/build/sysroot/portable-$1 directory=$1-linux-gnu
  local include libraries module
  run_quietly "Getting the libraries for $processor" scripts/sysroot "portable-$processor"
  make_compiler "$processor" "$build/compiler"
  include="-I$build/compiler/include -isystem $inputs/usr/include/$directory -isystem $inputs/usr/include"
  libraries=$inputs/usr/lib/$directory
  module="$libraries/libgcc_s.so.1 -Wl,--version-script=$work/source/packaging/portable/module.map"
  export CCACHE_COMPILERCHECK="string:zig $zig_version $processor $glibc" CCACHE_BASEDIR=$PWD
  options=(-DCMAKE_BUILD_TYPE=Release -DG4LIDAR_UNITE=ON -DG4LIDAR_DEVICE=ON
    "-DCMAKE_C_COMPILER=$build/compiler/clang" "-DCMAKE_CXX_COMPILER=$build/compiler/clang++"
    "-DCMAKE_AR=$build/compiler/ar" "-DCMAKE_RANLIB=$build/compiler/ranlib"
    "-DCMAKE_CXX_FLAGS=$include -ffile-prefix-map=$CCACHE_BASEDIR=. -s"
    "-DCMAKE_EXE_LINKER_FLAGS=-L$libraries" "-DCMAKE_MODULE_LINKER_FLAGS=-L$libraries $module"
    "-DCMAKE_FIND_ROOT_PATH=$inputs" -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY
    -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY
    "-DCMAKE_LIBRARY_ARCHITECTURE=$directory")
  if [[ $processor != x86_64 ]]; then
    options+=(-DCMAKE_SYSTEM_NAME=Linux "-DCMAKE_SYSTEM_PROCESSOR=$processor" -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER)
  fi
}

# build_portable <processor>: the programs, in $work/<processor>/root; sets `options`. The man pages of another processor,
# which the programs print, are those of x86_64, which is built first.
build_portable() {
  local build=$work/$1
  set_options "$1"
  (
    cd "$work/source" || exit
    configure "$build/build" "${options[@]}" "-Dfmt_DIR=$work/source/packaging/portable" \
      -DG4LIDAR_BUILD_TOOLS=ON -DG4LIDAR_BUILD_SERVE=ON -DG4LIDAR_BUILD_ROS2=OFF -DG4LIDAR_BUILD_C=OFF \
      -DG4LIDAR_BUILD_TESTS=OFF -DG4LIDAR_BUILD_FUZZ=OFF -DG4LIDAR_BUILD_EXAMPLES=OFF -DG4LIDAR_INSTALL=ON \
      -DG4LIDAR_INSTALL_UDEV_RULE=ON
    build "$build/build" g4-dump g4-serve
  )
  rm -rf "$build/root"
  run_quietly "Installing them" cmake --install "$build/build" --prefix "$build/root"
  if [[ $1 != x86_64 ]]; then cp -r "$work/x86_64/root/share/man" "$build/root/share"; fi
}

# write_licences <processor> <directory> programs|module: the licences of what is linked into them, and its versions to
# $work/linked-in. Of Boost's, which have 2 MB, those of the files that are used.
write_licences() {
  local sysroot=build/sysroot/portable-$1 zig part name url licence package text version
  local modules
  modules=$(echo "${environment:-}"/lib/python3.*/site-packages)
  zig=$(echo "$work"/zig/lib/python*/site-packages/ziglang)
  mkdir -p "$2"
  while read -r part name url licence; do
    if [[ $part != all && $part != "$3" ]]; then continue; fi
    package=${url##*/}
    case $url in
      deb/*)
        text=$sysroot/usr/share/doc/$package/copyright
        version=$(awk -v name="$package" '$1 == name { print $2 "?arch=" $3 "&distro=debian-12&upstream=" $4 }' \
          "$sysroot/packages")
        ;;
      generic/*)
        text=$zig/lib/$name/LICENSE.TXT
        version=$("$work/$1/compiler/clang" --version | awk '{ print $3; exit }')
        ;;
      */ziglang) text=$zig/LICENSE version=$zig_version ;;
      */nanobind)
        text=$(echo "$modules"/nanobind-*.dist-info/licenses/LICENSE)
        version=${text##*/nanobind-} version=${version%%.dist-info*}
        ;;
      */robin-map)
        text=$modules/nanobind/ext/robin_map/include/tsl/robin_map.h
        version=$(sed -n 's/^#define TSL_RH_VERSION_[A-Z]* //p' "${text%/*}/robin_growth_policy.h" | paste -s -d .)
        ;;
    esac
    if [[ ! $version ]]; then return 1; fi
    case $name in
      boost) awk 'BEGIN { RS = ""; ORS = "\n\n" }
        /^Files: \*\n|\nLicense: BSL-1.0 and Zlib|^License: (BSL-1.0|Zlib)\n/' "$text" ;;
      robin-map) sed '/\*\//q' "$text" ;;
      *) cat "$text" ;;
    esac >"$2/$name.txt"
    printf '%s\t%s\tpkg:%s@%s\t%s\n' "$3" "$name" "$url" "$version" "$licence" >>"$work/linked-in"
  done < <(grep -v '^#' "$work/source/packaging/portable/linked-in.txt")
  cp "$work/source/LICENSE" "$2/g4lidar.txt"
}

# write_sbom <version> <file>: what is linked into all that was made, as CycloneDX has it.
write_sbom() {
  fetch "$work/sbom" python3 'cyclonedx-python-lib[json-validation]==11.12.0'
  "$work/sbom/bin/python" packaging/portable/sbom.py "$1" "$2" <"$work/linked-in"
}

# check_programs <file>...: fails if one needs what glibc 2.28 does not have: a newer version of a name, or a name without
# a version, which may be missing when it is called. Python's names have none. Nor may one need a library of others.
check_programs() {
  local program
  for program in "$@"; do
    if readelf --dynamic "$program" | grep NEEDED | grep -vE '\[(lib(c|m|dl|pthread|rt|gcc_s)|ld-linux-.*)\.so\.[0-9]\]' \
      || ! readelf --wide --dyn-syms "$program" | awk -v newest="$glibc" '
        $7 == "UND" && $8 != "" && $5 != "WEAK" && $8 !~ /@|^_?Py/ { print "without a version: " $8; bad = 1 }
        $7 == "UND" && match($8, /@GLIBC_[0-9.]+/) {
          split(substr($8, RSTART + 7), version, "."); split(newest, most, ".")
          if ($5 != "WEAK" && (version[1] > most[1] || version[2] + 0 > most[2] + 0)) { print "too new: " $8; bad = 1 }
          ++found
        }
        END { exit bad || found == 0 }'; then
      echo "$program does not run with glibc $glibc" >&2
      return 1
    fi
  done
}

# check_no_addresses <directory> [<option of grep>]...: fails if a file in it has a path or the name of this machine.
check_no_addresses() {
  local name patterns=(-e "$PWD" -e "$work")
  name=$(uname -n)
  if ((${#name} > 5)) && [[ $name != localhost ]]; then patterns+=(-e "$name"); fi
  if grep --recursive --files-with-matches --text --fixed-strings "${patterns[@]}" "$@"; then
    echo "These files have a path or the name of this machine in them" >&2
    return 1
  fi
}

# make_portable <processor> <version> <directory>: the archive, in that directory.
make_portable() {
  local processor=$1 name=g4lidar-$2-linux-$1 root=$work/$1/root to=$work/$1/archive/
  build_portable "$processor"
  rm -rf "$to"
  mkdir -p "$to/$name/share"
  to+=$name
  cp -r "$root/bin" "$to"
  mkdir -p "$to/lib"
  cp -r "$root/lib/udev" "$to/lib"
  cp -r "$root"/share/{bash-completion,fish,man,zsh} "$to/share"
  cp "$work"/source/packaging/portable/{install.sh,README.md} "$work/source/LICENSE" "$to"
  write_licences "$processor" "$to/licenses" programs
  check_programs "$to"/bin/*
  check_no_addresses "$to"
  (cd "$to" && find . -type f -printf '%P\n' | sort | xargs sha256sum >"$work/sums")
  mv "$work/sums" "$to/SHA256SUMS"
  tar --create --directory "$work/$processor/archive" --sort=name --owner=0 --group=0 --numeric-owner \
    --mode=u=rwX,go=rX --mtime="@$SOURCE_DATE_EPOCH" "$name" | gzip -n9 >"$3/$name.tar.gz"
}
