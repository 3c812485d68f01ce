# SPDX-License-Identifier: MIT
# The sentences of a Markdown document that have too many words. A sentence ends with its paragraph, list item or cell of
# a table at the latest. Code counts as one word, a link by its text.
#   awk -v most=25 -f limits.awk DOCUMENT

function judge(sentence,    words, count, i) {
  count = 0
  for (i = split(sentence, words, " "); i > 0; --i) if (words[i] ~ /[A-Za-z0-9]/) ++count
  if (count > most) {
    sub(/^ +/, "", sentence)
    printf "%s:%d: a sentence of %d words: %s\n", FILENAME, first, count, sentence
    found = 1
  }
}

# The sentences of a paragraph, an item or a cell.
function divide(text,    at) {
  gsub(/<!--[^>]*-->|<[^>]*>/, " ", text)
  gsub(/`[^`]*`/, "CODE", text)
  gsub(/\]\([^)]*\)/, "", text) # of a link, its text stays
  gsub(/[][*!]*\[/, "", text)
  gsub(/ · /, ". ", text)
  while (match(text, /[.!?][])"*_]*( |$)/)) {
    judge(substr(text, 1, RSTART))
    text = substr(text, RSTART + RLENGTH)
  }
  judge(text)
}

function end_of_block() {
  divide(block)
  block = ""
}

/^```/ {
  end_of_block()
  is_code = !is_code
  next
}
is_code { next }
/^\|/ {
  end_of_block()
  first = FNR
  line = $0
  while (match(line, /`[^`]*`/)) line = substr(line, 1, RSTART - 1) "CODE" substr(line, RSTART + RLENGTH)
  count = split(line, cells, "|")
  for (i = 1; i <= count; ++i) divide(cells[i])
  next
}
/^ *$|^#|^ *([-*>]|[0-9]+\.) |^!\[/ { end_of_block() }
/^ *$/ { next }
{
  sub(/^ *([-*>#]+|[0-9]+\.) /, "")
  if (block == "") first = FNR
  block = block " " $0
}
END {
  end_of_block()
  exit found
}
