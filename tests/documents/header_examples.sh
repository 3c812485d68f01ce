#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Prints the examples in the comments of headers as a document for extract.sh: header_examples.sh LIST DIRECTORY
# An example is a block of a documentation comment that is indented by four spaces or more, behind an empty line. Each
# must stand in LIST (header_examples.txt), with the wrapper in which it is compiled, and LIST names nothing else.
# The path of a port becomes the variable `device` of the wrapper.
set -euo pipefail
list=$1
directory=$2
cd "$directory"
# shellcheck disable=SC2016 # the dollars are those of awk
find . -name '*.hpp' -o -name '*.h' | sort | sed 's#^\./##' | xargs awk -v list="$list" '
  function finish() {
    if (!inside) return
    inside = 0
    if (how == "text") {
      if (has_code) complain("is code, and is listed as text")
      return
    }
    printf "\n%s:%d:\n\n<!-- test: in %s -->\n```cpp\n%s```\n", FILENAME, first, how, block
  }
  function complain(text) {
    printf "%s/%s:%d: this example %s\n", ENVIRON["PWD"], FILENAME, first, text > "/dev/stderr"
    failed = 1
  }
  BEGIN {
    while ((getline line < list) > 0) {
      if (split(line, word, " ") == 3 && line !~ /^#/) listed[word[1] " " word[2]] = word[3]
    }
  }
  FNR == 1 { count = is_empty = 0 }
  {
    text = $0
    is_comment = sub(/^ *(\/\/\/| \*|\*)/, "", text)
    if (inside && !(is_comment && text ~ /^     /)) finish()
    if (!inside && is_comment && is_empty && text ~ /^     +[^ ]/) {
      inside = 1
      first = FNR
      block = ""
      has_code = 0
      place = FILENAME " " ++count
      how = listed[place]
      if (how == "") complain("is not in " list)
      delete listed[place]
    }
    if (inside) {
      line = substr(text, 6)
      gsub(/"\/dev\/ttyUSB0"/, "device", line)
      if (line ~ /;$/) has_code = 1
      block = block line "\n"
    }
    is_empty = is_comment && text ~ /^ *$/
  }
  END {
    finish()
    for (place in listed) {
      printf "%s: there is no example %s\n", list, place > "/dev/stderr"
      failed = 1
    }
    exit failed
  }'
