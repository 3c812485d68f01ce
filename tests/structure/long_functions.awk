# SPDX-License-Identifier: MIT
# awk -v most=<number> -f long_functions.awk <header or source>...
#
# Prints "<file>:<line>: a function of <n> lines" for each function with more than <most> lines: from the line at which
# it begins to the brace at the same indentation. The sources are in the format of clang-format. A constant, also one
# that a function makes, is a table and no function.

FNR == 1 { inside = 0; head = "" }

inside {
  match($0, /^ */)
  if (RLENGTH == indent && $0 ~ /^ *}/) {
    lines = FNR - begin + 1
    if (lines > most) print FILENAME ":" begin ": a function of " lines " lines"
    inside = 0
  }
  next
}

/^ *\/\// { next }
/^ *(#|$)/ { head = ""; next }

{
  if (head == "") {
    match($0, /^ */)
    indent = RLENGTH
    begin = FNR
  }
  line = $0
  sub(/ *\/\/.*/, "", line)
  head = head line
  if (line ~ /\{$/) {
    inside = head ~ /\(/ && head !~ /^ *(template *<.*> *)?(inline +)?(namespace|class|struct|union|enum|extern "C")/ &&
             head !~ /^ *(inline |static )*constexpr [^(]* = /
    head = ""
  } else if (line ~ /[;}:]$/) {
    head = ""
  }
}
