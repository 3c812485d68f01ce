# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Makes the wheels of the Python module and of the programs, for every Linux with glibc 2.28, and the source
# distribution. Sourced by scripts/release; needs bash.

source scripts/portable.sh # the compiler
source scripts/pythons.sh
wheel_platform=manylinux_2_28_x86_64
wheel_needs=(auditwheel==6.8.2 build==1.6.1 nanobind==3.1.0 numpy scikit-build-core==1.1.2 wheel==0.48.0)

# make_environment <minor> <python>: sets `environment`, one of this Python with what makes wheels.
make_environment() {
  local made_of="$2 ${wheel_needs[*]}"
  environment=$work/python-3.$1
  if [[ ! -e $environment/made_of || $(<"$environment/made_of") != "$made_of" ]]; then
    rm -rf "$environment"
    run_quietly "Making a place for Python 3.$1" "$2" -m venv "$environment"
    run_quietly "Fetching what makes wheels" \
      "$environment/bin/pip" install --quiet --disable-pip-version-check "${wheel_needs[@]}"
    echo "$made_of" >"$environment/made_of"
  fi
}

# pack_wheel <directory> <dist>: checks an unpacked wheel, names its licences, and packs it for manylinux.
pack_wheel() {
  local packed=$work/packed info programs
  info=$(echo "$1"/*.dist-info)
  (cd "$info/licenses" && printf 'License-File: %s\n' *) >"$work/licences"
  sed -i -e '/^License-File: /d' -e "/^License-Expression: /r $work/licences" "$info/METADATA"
  mapfile -t programs < <(find "$1" -name '*.so' -o -path '*.data/scripts/*')
  check_programs "${programs[@]}"
  check_no_addresses "$1"
  rm -rf "$packed"
  mkdir "$packed"
  "$environment/bin/wheel" pack --dest-dir "$packed" "$1" >/dev/null
  "$environment/bin/wheel" tags --remove --platform-tag "$wheel_platform" "$packed"/*.whl >/dev/null
  "$environment/bin/auditwheel" show "$packed"/*.whl >"$work/audited"
  if ! tr '\n' ' ' <"$work/audited" | grep -q "is consistent with the following platform tag: \"$wheel_platform\""; then
    cat "$work/audited" >&2
    return 1
  fi
  mv "$packed"/*.whl "$2"
}

# make_module <minor> <python> <dist>: the wheel of the module for this Python.
make_module() {
  local wheels=$work/wheels info packages
  make_environment "$1" "$2"
  rm -rf "$wheels"
  (
    cd "$work/source" || exit
    IFS=';'
    if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
    run_quietly "Building the wheel for Python 3.$1" "$environment/bin/pip" wheel --quiet --disable-pip-version-check \
      --no-build-isolation --no-deps -w "$wheels" "--config-settings=cmake.args=${options[*]}" .
  )
  "$environment/bin/wheel" unpack --dest "$wheels" "$wheels"/*.whl >/dev/null
  info=$(echo "$wheels"/*/*.dist-info)
  packages=$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("platlib"))')
  write_licences x86_64 "$info/licenses"
  cp "$packages"/nanobind-*.dist-info/licenses/LICENSE "$info/licenses/nanobind.txt"
  sed '/\*\//q' "$packages/nanobind/ext/robin_map/include/tsl/robin_map.h" >"$info/licenses/robin-map.txt"
  pack_wheel "${info%/*}" "$3"
}

# make_tools <version> <dist>: the wheel of the programs, which serves every Python 3.
make_tools() {
  local wheel=$work/tools/g4lidar_tools-$1 root=$work/x86_64/root
  local info=$wheel/${wheel##*/}.dist-info data=$wheel/${wheel##*/}.data
  rm -rf "$work/tools"
  mkdir -p "$info" "$data/data/share"
  cp -r "$root/bin" "$data/scripts"
  cp -r "$root"/share/{bash-completion,fish,man,zsh} "$data/data/share"
  sed "s/@version@/$1/" "$work/source/packaging/portable/METADATA" >"$info/METADATA"
  printf '%s\n' 'Wheel-Version: 1.0' 'Root-Is-Purelib: false' 'Tag: py3-none-linux_x86_64' >"$info/WHEEL"
  write_licences x86_64 "$info/licenses" "${program_licences[@]}"
  pack_wheel "$wheel" "$2"
}

# make_wheels <version> <dist>: all of them. Those for a Python that is not there are left out, with a line "SKIPPED".
make_wheels() {
  local pythons python last=9 environment headers=build/sysroot/portable-x86_64/usr/include/x86_64-linux-gnu
  build_portable x86_64 # sets `options`
  # Debian's headers of Python name those of the processor.
  mkdir -p "$headers"
  while read -r python; do
    ln -sfn "$python" "$headers"
  done < <(compgen -G '/usr/include/x86_64-linux-gnu/python3.*')
  rm -f "$2"/*.whl
  mapfile -t pythons < <(find_pythons)
  for python in "${pythons[@]}"; do
    # From 3.12 on one serves all later versions.
    if ((${python%% *} < 10 || last >= 12)); then continue; fi
    last=${python%% *}
    make_module "$last" "${python#* }" "$2"
  done
  for python in 10 11 12; do
    if ! compgen -G "$2/*-cp3$python-*.whl" >/dev/null; then
      echo "SKIPPED: the wheel for Python 3.$python, which is not here"
    fi
  done
  if [[ ! ${environment:-} ]]; then return 1; fi
  make_tools "$1" "$2"
  run_quietly "Making the source distribution" \
    "$environment/bin/python" -m build --no-isolation --sdist -o "$2" "$work/source"
}
