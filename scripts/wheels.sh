# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Makes the wheels of the Python module and of the programs, for every Linux with glibc 2.28, and the source
# distribution. Sourced by scripts/release; needs bash.

source scripts/portable.sh # the compiler
source scripts/pythons.sh
wheel_needs=(auditwheel==6.8.2 build==1.6.1 nanobind==3.1.0 numpy scikit-build-core==1.1.2 wheel==0.48.0)

# pack_wheel <directory> <processor> <dist>: checks an unpacked wheel, names its licences, and packs it for manylinux.
pack_wheel() {
  local packed=$work/packed platform=manylinux_2_28_$2 info programs
  info=$(echo "$1"/*.dist-info)
  (cd "$info/licenses" && printf 'License-File: %s\n' *) >"$work/licences"
  sed -i -e '/^License-File: /d' -e "/^License-Expression: /r $work/licences" "$info/METADATA"
  mapfile -t programs < <(find "$1" -name '*.so' -o -path '*.data/scripts/*')
  check_programs "${programs[@]}"
  check_no_addresses "$1"
  rm -rf "$packed"
  mkdir "$packed"
  "$environment/bin/wheel" pack --dest-dir "$packed" "$1" >/dev/null
  "$environment/bin/wheel" tags --remove --platform-tag "$platform" "$packed"/*.whl >/dev/null
  # auditwheel knows the processor of this machine alone; check_programs does the same for all.
  if [[ $2 == "$(uname -m)" ]]; then "$environment/bin/auditwheel" show "$packed"/*.whl >"$work/audited"; fi
  if [[ $2 == "$(uname -m)" ]] \
    && ! tr '\n' ' ' <"$work/audited" | grep -q "is consistent with the following platform tag: \"$platform\""; then
    cat "$work/audited" >&2
    return 1
  fi
  mv "$packed"/*.whl "$3"
}

# make_module <minor> <python> <processor> <dist>: the wheel of the module for this Python; sets `environment`. The
# headers of Python and the stubs, which need a module that runs, are those of x86_64, which is made first.
make_module() {
  local wheels=$work/wheels/3.$1-$3 suffix=.cpython-3$1-$3-linux-gnu.so info cross=()
  environment=$work/python-3.$1
  fetch "$environment" "$2" "${wheel_needs[@]}"
  if [[ $3 != x86_64 ]]; then cross=(--config-settings=build.targets=_g4lidar); fi
  rm -rf "$wheels"
  (
    cd "$work/source" || exit
    IFS=';'
    if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)} _PYTHON_HOST_PLATFORM=linux-$3
    export SETUPTOOLS_EXT_SUFFIX=$suffix
    run_quietly "Building the wheel for Python 3.$1, $3" "$environment/bin/pip" wheel --quiet \
      --disable-pip-version-check --no-build-isolation --no-deps -w "$wheels" "--config-settings=cmake.args=${options[*]}" "${cross[@]}" .
  )
  "$environment/bin/wheel" unpack --dest "$wheels" "$wheels"/*.whl >/dev/null
  info=$(echo "$wheels"/*/*.dist-info)
  if (($1 >= 12)); then suffix=.abi3.so; fi
  test -s "${info%/*}/g4lidar/_g4lidar$suffix"
  if [[ $3 != x86_64 ]]; then cp "$work/wheels/3.$1-x86_64"/*/g4lidar/_g4lidar.pyi "${info%/*}/g4lidar"; fi
  write_licences "$3" "$info/licenses" module
  pack_wheel "${info%/*}" "$3" "$4"
}

# make_tools <version> <processor> <dist>: the wheel of the programs, which serves every Python 3.
make_tools() {
  local wheel=$work/tools/g4lidar_tools-$1 root=$work/$2/root
  local info=$wheel/${wheel##*/}.dist-info data=$wheel/${wheel##*/}.data
  rm -rf "$work/tools"
  mkdir -p "$info" "$data/data/share"
  cp -r "$root/bin" "$data/scripts"
  cp -r "$root"/share/{bash-completion,fish,man,zsh} "$data/data/share"
  sed "s/@version@/$1/" "$work/source/packaging/portable/METADATA" >"$info/METADATA"
  printf '%s\n' 'Wheel-Version: 1.0' 'Root-Is-Purelib: false' "Tag: py3-none-linux_$2" >"$info/WHEEL"
  write_licences "$2" "$info/licenses" programs
  pack_wheel "$wheel" "$2" "$3"
}

# need_pythons: sets `pythons`. Without PYTHONS a line "SKIPPED" names each missing one; --final refuses that.
# shellcheck disable=SC2154
need_pythons() {
  local python
  mapfile -t pythons < <(find_pythons)
  for python in 10 11 '1[2-9]'; do
    if printf '%s\n' "${pythons[@]}" | grep -q "^$python "; then continue; fi
    if [[ ${final[*]} ]]; then refuse "the wheels need Python 3.$python"; fi
    if [[ ! ${PYTHONS:-} ]]; then echo "SKIPPED: the wheel for Python 3.$python, which is not here"; fi
  done
}

# make_wheels <version> <dist>: all of them, for `processors` of scripts/release and `pythons`.
# shellcheck disable=SC2154
make_wheels() {
  local python last processor environment headers
  rm -rf "$2"/*.whl "$work/wheels"
  for processor in "${processors[@]}"; do
    build_portable "$processor" # sets `options`
    # Debian's headers of Python name those of the processor.
    headers=build/sysroot/portable-$processor/usr/include/$processor-linux-gnu
    mkdir -p "$headers"
    while read -r python; do
      ln -sfn "$python" "$headers"
    done < <(compgen -G '/usr/include/x86_64-linux-gnu/python3.*')
    last=9
    for python in "${pythons[@]}"; do
      # From 3.12 on one serves all later versions.
      if ((${python%% *} < 10 || last >= 12)); then continue; fi
      last=${python%% *}
      make_module "$last" "${python#* }" "$processor" "$2"
    done
    if [[ ! ${environment:-} ]]; then return 1; fi
    make_tools "$1" "$processor" "$2"
  done
  run_quietly "Making the source distribution" \
    "$environment/bin/python" -m build --no-isolation --sdist -o "$2" "$work/source"
}
