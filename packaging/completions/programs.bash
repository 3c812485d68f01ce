# SPDX-License-Identifier: MIT
# Completion for bash of each program, which lists what can follow; a line / stands for names of files.
# shellcheck shell=bash

_g4lidar() {
  local words typed word begin
  read -ra words <<<"${COMP_LINE:0:COMP_POINT}"
  if [[ ${COMP_LINE:0:COMP_POINT} == *[[:space:]] ]]; then words+=(''); fi
  typed=${words[-1]}
  COMPREPLY=()
  while IFS=$'\t' read -r word _; do
    if [[ $word == / ]]; then
      mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$typed")
    else
      COMPREPLY+=("$word")
    fi
  done < <("$1" --complete "${words[@]:1}" 2>/dev/null)
  # bash splits words at = and : and replaces only what follows them.
  begin=${typed%"${typed##*[=:]}"}
  COMPREPLY=("${COMPREPLY[@]#"$begin"}")
}

complete -o filenames -F _g4lidar g4-dump g4-ros2 g4-serve
