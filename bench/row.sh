# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The table of measurements and promises. Sourced.
missed=0 # the verdict, for the script that sources this
export missed

heading() {
  echo "| what | measured | promised |"
  echo "|---|---|---|"
}

# row <name> <value> <unit> [<maximum> <promise as shown>]
row() {
  printf '| %-52s | %12s %-10s | %s |\n' "$1" "$2" "$3" "${5:-}"
  if [[ -n ${4:-} ]] && awk -v v="$2" -v most="$4" 'BEGIN { exit !(v > most) }'; then
    echo "Missed: $1 is $2 $3, promised ${5}" >&2
    missed=1
  fi
}

# value <name> <file>: the value of a line "name value".
value() { awk -v name="$1" '$1 == name { print $2 }' "$2"; }

# ticks <process>: of processor time that it has used, in 10 ms.
ticks() { awk '{ print $14 + $15 }' "/proc/$1/stat"; }

# percent <ticks> <seconds>: of a core.
percent() { awk -v used="$1" -v seconds="$2" 'BEGIN { printf "%.2f", used / seconds }'; }
