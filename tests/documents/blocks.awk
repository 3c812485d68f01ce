# SPDX-License-Identifier: MIT
# Extracts the fenced blocks of a Markdown document: block N of language L becomes the file N.L in
# the directory `out`, and a line in `out`/list: N, L, the number of its first line, and its mark,
# separated by tabs. The mark is the comment <!-- test: MARK --> directly before the block. Unknown
# marks are errors: no block is ignored.
#   awk -v out=DIRECTORY -f blocks.awk DOCUMENT

function fail(text) {
  printf "%s:%d: %s\n", FILENAME, FNR, text > "/dev/stderr"
  failed = 1
  exit 1
}

function is_known(language, mark) {
  if (mark ~ /^not run: ...../) return 1  # with a reason
  if (mark ~ /^file [A-Za-z0-9_.\/-]+$/) return language != "sh"
  if (language == "cpp" && mark == "until ^C") return 1
  if (language == "python") return mark == ""
  if (language == "c" || language == "cpp" || language == "cmake") return mark ~ /^(|in [a-z_]+)$/
  if (language == "sh") return mark ~ /^(|until \^C|the only lidar|three of four|exit [0-9]+)$/
  if (language == "text") return mark ~ /^output(, but for numbers)?$/
  return 0
}

inside && $0 == "```" {
  inside = 0
  close(file)
  mark = ""
  next
}
inside {
  print > file
  next
}
/^<!-- test: .* -->$/ {
  if (mark != "") fail("two marks before one block")
  mark = substr($0, 12, length($0) - 15)
  next
}
/^```/ {
  inside = 1
  language = substr($0, 4)
  if (!is_known(language, mark)) {
    fail("the test does not know what to do with a block '" language "' that is marked '" mark "'")
  }
  file = out "/" ++count "." language
  printf "" > file
  printf "%d\t%s\t%d\t%s\n", count, language, FNR + 1, mark > (out "/list")
  next
}
/^[ >]+```/ { fail("a fence that does not begin its line") }
mark != "" { fail("the mark '" mark "' is not right before a block") }
/<!-- *test/ { fail("a mark that does not fill its line") }
END {
  if (failed) exit 1
  if (inside) fail("the last block has no end")
}
