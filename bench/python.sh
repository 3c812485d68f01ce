#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What the Python module costs beside other packages of PyPI, which read the same simulated lidar (9 kHz, 7 Hz) one after
# the other: PyLidar3, lds2d, and a loop over packets in the manner of rplidar-roboticia. Promised is at most a tenth of the
# processor time of the best of them, and at least half the speed of bulk decoding in C++.
#   bench/python.sh [SECONDS [REPETITIONS]]: of each measurement, 10 and 3 by default. A cell is the median.
# PYTHON=<program> uses another Python, 3.11 or later. Skips without a network.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/packages.sh
source scripts/build.sh
seconds=${1:-10}
repetitions=${2:-3}

need_packages "${packages_bench[@]}" python3-dev python3-venv
scratch=$(mktemp -d -t g4lidar-python-bench.XXXXXX)
pids=()
cleanup() {
  ((${#pids[@]} == 0)) || kill "${pids[@]}" 2>/dev/null || true
  wait
  rm -rf "$scratch"
}
trap cleanup EXIT
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

"${PYTHON:-/usr/bin/python3}" -m venv "$scratch/venv"
pip=("$scratch/venv/bin/pip" --quiet --disable-pip-version-check)
if ! run_quietly "Installing the packages" "${pip[@]}" install scikit-build-core==1.1.2 nanobind==3.1.0 numpy==2.4.6 \
  PyLidar3==1.6 lds2d==0.7.0 pyserial==3.5; then
  echo "SKIPPED: the Python packages could not be installed (no network?)"
  exit 77
fi
run_quietly "Building the module" "${pip[@]}" install --no-build-isolation --no-deps .
python=$scratch/venv/bin/python
g4_dump=${G4_DUMP:-}
if [[ -z $g4_dump ]]; then
  configure_preset release
  build build/release g4-dump
  g4_dump=build/release/g4-dump
fi
configure_preset bench
build build/bench decode_bench

"$g4_dump" sim --link "$scratch/g4" >/dev/null 2>&1 &
pids+=($!)
for _ in {1..200}; do
  if [[ -e $scratch/g4 ]]; then break; fi
  sleep 0.05
done

names=(g4lidar pylidar3 lds2d loop)
for ((run = 1; run <= repetitions; ++run)); do
  for name in "${names[@]}"; do
    timeout 120 "$python" bench/python/read.py "$name" "$scratch/g4" "$seconds" >>"$scratch/$name"
    sleep 1 # the motor stops
  done
done
# median <column> <file>
median() { awk -v c="$1" '{ print $c }' "$2" | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
printf '| reader | processor time per second, ms | scans per second | points or directions per second |\n|---|---|---|---|\n'
for name in "${names[@]}"; do
  printf '| %s | %s | %s | %s |\n' "$name" "$(median 1 "$scratch/$name")" "$(median 2 "$scratch/$name")" \
    "$(median 3 "$scratch/$name")"
done
code=0
best=$(for name in "${names[@]:1}"; do median 1 "$scratch/$name"; done | sort -g | head -n 1)
ours=$(median 1 "$scratch/g4lidar")
echo "processor time of g4lidar / that of the best other one: $(awk -v a="$ours" -v b="$best" 'BEGIN { printf "%.3f", a / b }')"
if awk -v a="$ours" -v b="$best" 'BEGIN { exit !(a > b / 10) }'; then
  echo "Missed: more than a tenth of the best other reader" >&2
  code=1
fi

"$g4_dump" sim --seconds 60 --seed 1 -o "$scratch/raw"
for ((run = 1; run <= repetitions; ++run)); do
  build/bench/bench/decode_bench "$scratch/raw" 100 >>"$scratch/cpp"
  "$python" bench/python/decode.py "$scratch/raw" 100 >>"$scratch/python"
done
printf '\n| memory for the points | C++, million points per second | Python | ratio |\n|---|---|---|---|\n'
for memory in reused new; do
  for language in cpp python; do grep "^$memory" "$scratch/$language" >"$scratch/$language.$memory"; done
  cpp=$(median 2 "$scratch/cpp.$memory")
  in_python=$(median 2 "$scratch/python.$memory")
  awk -v m="$memory" -v a="$cpp" -v b="$in_python" \
    'BEGIN { printf "| %s | %.0f | %.0f | %.2f |\n", m, a / 1e6, b / 1e6, b / a }'
  if awk -v a="$cpp" -v b="$in_python" 'BEGIN { exit !(b < a / 2) }'; then
    echo "Missed: decoding in Python, memory $memory: less than half the speed of C++" >&2
    code=1
  fi
done
((code == 0))
