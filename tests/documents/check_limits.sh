#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The README has at most 150 lines, a page at most 300, and a sentence of them at most 25 words. No link of a
# document leads nowhere. Each promise of docs/promises.md names its test. Each command of the README's table "I want
# to ..." works, as it stands and with a lidar.
#
# The commands are executed in order, in one scratch directory. Those that do not end by themselves get ^C when they have
# printed what is expected. Then they are executed without `sim:`, with a simulated lidar that discovery finds. What cannot
# be executed is printed: scripts/slam must stand in docs/maps.md, which documents.maps executes, and scripts/ci/python
# executes the Python of the README.
#
# Needs G4LIDAR_SOURCE_DIR, and G4_DUMP, with the other programs beside it; ROBOT and FIRST_SCAN, the examples in C++ and C.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$G4LIDAR_SOURCE_DIR"
failed=0

# refuse <word>...: prints what is wrong.
refuse() {
  echo "$*" >&2
  failed=1
}

# ---- lines, sentences, links, promises -----------------------------------------------------------

shopt -s nullglob
for page in docs/design/*.md; do
  if (($(wc -l <"$page") > 300)); then refuse "$page has more than 300 lines"; fi
done
for page in README.md SUPPORT.md CONTRIBUTING.md docs/*.md docs/guide/*.md docs/lidars/*.md examples/*/README.md; do
  most=300
  if [[ $page == README.md ]]; then most=150; fi
  lines=$(wc -l <"$page")
  if ((lines > most)); then refuse "$page has $lines lines, at most $most"; fi
  awk -v most=25 -f "$here/limits.awk" "$page" >&2 || failed=1
done
awk -f "$here/links.awk" ./*.md docs/*.md docs/*/*.md examples/*/*.md tests/*/*.md >&2 || failed=1
shopt -u nullglob
# check_words.sh looks whether the paths exist.
awk -F '|' '
  /^\| promise \| test \|$/ { is_table = 1; next }
  !/^\|/ { is_table = 0 }
  is_table && !/^\|-/ && $3 !~ /`(bench|fuzz|python|ros|scripts|tests)\// {
    printf "%s:%d: a promise without a test:%s\n", FILENAME, FNR, $2
    found = 1
  }
  END { exit found }' docs/promises.md >&2 || failed=1

# ---- the commands of the table -----------------------------------------------------------------

scratch=$(mktemp -d)
leave() {
  local left
  mapfile -t left < <(jobs -p)
  if ((${#left[@]} > 0)); then kill "${left[@]}" 2>/dev/null || true; fi
  wait 2>/dev/null || true
  rm -rf "$scratch"
}
trap leave EXIT
set -m # a background job is a process group of its own, which gets ^C as a whole
PATH=$(dirname "$G4_DUMP"):$PATH
export TERM=xterm ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
patience=120 # seconds, for what takes some

# make_place <directory>: where the commands are executed, with the programs that the README shows.
make_place() {
  mkdir "$scratch/$1"
  cd "$scratch/$1"
  ln -s "$ROBOT" robot
  ln -s "$FIRST_SCAN" first_scan
  cp "$scratch/scans.py" .
}

# expected <words>: a regular expression for the output of this command.
expected() {
  case $1 in
    'g4-dump view '* | 'g4-dump view') echo 'frequency.*Hz' ;;
    'g4-dump serve'*) echo 'http://127\.0\.0\.1:[0-9]+/' ;;
    # A machine that is busy is no fault of the lidar.
    'g4-dump doctor'*) echo '^healthy: nothing is wrong$|^ *found: host_busy$' ;;
    'g4-dump scan'*svg*) echo '1 scan ' ;;
    'g4-dump scan'*) echo ' whole$' ;;
    'g4-dump record'*) echo '^walk\.mcap: .* [0-9]+ scans$' ;;
    g4-ros2*) echo '^lidar: running$' ;;
    ./robot* | ./first_scan* | 'python3 scans.py'*) echo '^[0-9]+ points at [0-9.]+ Hz$' ;;
    *) return 1 ;;
  esac
}

# has_ended <process>
has_ended() { ! kill -0 "$1" 2>/dev/null; }

# await_output <process> <regular expression>: waits until its output is as expected, or it has ended.
await_output() {
  local i
  for ((i = 0; i < patience * 10; ++i)); do
    if grep -qaE -e "$2" "$scratch/out" || has_ended "$1"; then return; fi
    sleep 0.1
  done
}

# is_served: the server that printed its address has a page and a lidar that runs.
is_served() {
  local port answer i
  port=$(grep -oE '127\.0\.0\.1:[0-9]+' "$scratch/out" | head -n 1)
  for ((i = 0; i < patience * 10; ++i)); do
    answer=$(exec 3<>"/dev/tcp/127.0.0.1/${port#*:}" &&
      printf 'GET /status.json HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n' >&3 && cat <&3) 2>/dev/null || true
    if [[ $answer == *'"state":"running"'* ]]; then return 0; fi
    sleep 0.1
  done
  return 1
}

# execute <words>: as a user would type it; ^C when the output is as expected. Its exit code.
execute() {
  local words=$1 wanted pid code=0
  wanted=$(expected "$1")
  : >"$scratch/out"
  if [[ $words == 'g4-dump serve'* ]]; then words+=' --port 0'; fi # the usual one may be in use
  if [[ $words == 'g4-dump view'* ]]; then                         # on a terminal, where q ends it
    mkfifo "$scratch/keys"
    script --quiet --flush --return --command "stty rows 24 columns 80; exec $words" /dev/null \
      <"$scratch/keys" >"$scratch/out" 2>&1 &
    pid=$!
    exec 4>"$scratch/keys"
    await_output "$pid" "$wanted"
    printf q >&4
    exec 4>&-
    rm "$scratch/keys"
    wait "$pid"
    return
  fi
  bash -c "$words" >"$scratch/out" 2>&1 </dev/null &
  pid=$!
  case $words in
    # These end by themselves.
    'g4-dump doctor'* | 'g4-dump record'* | *' -n '* | ./* | python3*) ;;
    *)
      await_output "$pid" "$wanted"
      if [[ $words == 'g4-dump serve'* ]]; then is_served || return 1; fi
      kill -INT -- "-$pid" 2>/dev/null || true
      ;;
  esac
  wait "$pid" || code=$?
  if ((code == 130)); then code=0; fi
  return "$code"
}

# check <row> <words>: the command succeeds and prints what is expected. On a busy machine the doctor may find faults of
# the machine: then it is tried again.
check() {
  local words=$2 wanted tries=1 code
  if ! wanted=$(expected "$words"); then
    refuse "README.md: this test does not know what '$words' is expected to print"
    return
  fi
  if [[ $words == 'g4-dump doctor'* ]]; then tries=4; fi
  while ((tries > 0)); do
    code=0
    execute "$words" || code=$?
    if ((code == 0)) && grep -qaE -e "$wanted" "$scratch/out"; then return; fi
    tries=$((tries - 1))
  done
  refuse "README.md, \"$1\": '$words' ended with $code, and printed:"
  sed 's/^/  /' "$scratch/out" | head -n 40 >&2
}

# is_skipped <words>: whether a command cannot be executed here.
is_skipped() {
  case $1 in
    g4-ros2*) ! command -v g4-ros2 >/dev/null ;;
    'g4-dump serve'*) ! command -v g4-serve >/dev/null ;;
    python3*) ! python3 -c 'import g4lidar' 2>/dev/null ;;
    scripts/*)
      grep -qxF -e "$1" "$G4LIDAR_SOURCE_DIR/docs/maps.md" || refuse "README.md: '$1' is in no block of docs/maps.md"
      ;;
    *) return 1 ;;
  esac
}

# The commands, each with what it is for: lines "purpose|command".
awk -F '|' '
  /^\| I want to / { is_table = 1; next }
  !/^\|/ { is_table = 0 }
  is_table && !/^\|-/ {
    count = split($3, parts, "`")
    for (i = 2; i <= count; i += 2) print $2 "|" parts[i]
    if (count < 3) print $2 "|"
  }' README.md | sed -E 's/^ +//; s/ +\|/|/' >"$scratch/commands"
if [[ ! -s $scratch/commands ]]; then refuse "README.md has no table \"I want to ...\""; fi
bash "$here/extract.sh" README.md "$scratch/blocks"
cat "$scratch"/blocks/*.python >"$scratch/scans.py" 2>/dev/null || true

make_place "alone"
while IFS='|' read -r purpose words <&5; do
  if [[ -z $words ]]; then
    refuse "README.md, \"$purpose\": there is no command"
  elif is_skipped "$words"; then
    echo "not executed here: $words"
  else
    check "$purpose" "$words"
  fi
done 5<"$scratch/commands"

# check_with_a_lidar: a simulated one that discovery finds.
check_with_a_lidar() {
  local i purpose words shorter
  export G4LIDAR_SIM_DIR=$scratch/lidars
  g4-dump sim --register >"$scratch/lidar" 2>&1 &
  for ((i = 0; i < patience * 10; ++i)); do
    if g4-dump list >/dev/null 2>&1; then break; fi
    sleep 0.1
  done
  make_place "with_a_lidar"
  while IFS='|' read -r purpose words <&5; do
    shorter=${words// sim:/}
    if [[ $shorter == "$words" ]] || is_skipped "$words"; then continue; fi
    check "$purpose" "$shorter"
  done 5<"$scratch/commands"
}

if g4-dump list >/dev/null 2>&1; then
  echo "not executed with a simulated lidar: a real one is attached to this machine"
else
  check_with_a_lidar
fi
((failed == 0))
