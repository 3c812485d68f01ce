# SPDX-License-Identifier: MIT
# awk -v most=<number> -v most_functions=<number> -f count_members.awk <header or source>...
#
# Prints "<file>: <class> has <n> data members" for each class with more than <most> of them, those
# of its base classes in the same files included, and "<file>: <class> has <n> functions" for each class with
# more than <most_functions> of its own, without constructors, destructor and what is defaulted or deleted. Several declarators are several members; static
# ones, types and functions are none. A nested class counts for itself; the members of an unnamed
# one belong to the class around it. Base classes are found by their last name.
# Not understood: members with an elaborated type (`struct a b;`).

# ---- statements ----------------------------------------------------------------------------------
# A statement is its tokens, with blanks between them, without what is in braces.

function without(text, pattern) {
  while (sub(pattern, " ", text)) {}
  return text
}

# Without attributes and the contents of <>, and with single blanks.
function simple(text) {
  text = without(text, "(alignas|decltype|explicit|noexcept|requires) \\( [^()]*\\)")
  text = without(text, "\\[ \\[ [^]]*\\] \\]")
  text = without(text, "< [^<>;]*>")
  gsub(/  +/, " ", text)
  sub(/^ /, "", text)
  return text
}

function is_class(text) {
  return text !~ /^enum / && text !~ /[(=]/ && text ~ /(^| )(class|struct|union) /
}

# A function, and not a pointer to one, nor a member whose value calls one.
function is_function(text) {
  sub(/ =.*/, "", text)
  return text ~ /\(/ && text !~ /\( \*/ || text ~ /(^| )operator( |$)/
}

# 1 if it declares or defines a function of the class, which is not special.
function functions_in(text, at) {
  if (text ~ /^(using|typedef|friend|static_assert|enum|union|extern) / || !is_function(text)) return 0
  if (text ~ / = (default|delete) *$/ || text ~ /~/) return 0
  sub(/ ?\(.*/, "", text)
  return text !~ ("(^| )" name_of[at] "$")
}

function declarators(text) {
  if (text == "") return 0
  if (text ~ /^(using|typedef|friend|static_assert|template|enum|class|struct|union|extern) /) return 0
  if (text ~ /(^| )static /) return 0
  if (is_function(text)) return 0
  text = without(text, "[(] [^()]*[)]")
  return gsub(/,/, ",", text) + 1
}

# ---- tokens --------------------------------------------------------------------------------------
function open_brace(    text, words, count, i, name) {
  text = simple(statement[depth])
  if (kind[depth] == "class" && !pending[depth] && !is_class(text)) functions[class[depth]] += functions_in(text, class[depth])
  pending[depth] = 0
  ++depth
  kind[depth] = "block"
  statement[depth] = ""
  pending[depth] = 0
  if (text ~ /^(inline )?namespace/ || text ~ /^extern "/) {
    kind[depth] = "namespace"
  } else if (is_class(text)) {
    kind[depth] = "class"
    sub(/^.*(class|struct|union)( |$)/, "", text)
    name = text
    sub(/ : .*/, "", name)
    sub(/ final *$/, "", name)
    sub(/ +$/, "", name)
    sub(/^.* /, "", name)
    class[depth] = ++classes
    name_of[classes] = name
    file_of[classes] = FILENAME
    own[classes] = 0
    if (sub(/^.* : /, "", text)) {
      gsub(/(^| )(public|protected|private|virtual)( |$)/, " ", text)
      bases_of[classes] = text
    }
  } else if (kind[depth - 1] == "class" && !is_function(text) && text !~ /^enum /) {
    kind[depth] = "value"
  }
}

function close_brace(    closed) {
  closed = kind[depth]
  if (closed == "class") {
    --depth
    statement[depth] = name_of[class[depth + 1]] == "" ? "unnamed" : "named"
    inner = class[depth + 1]
    return
  }
  --depth
  if (closed != "value") pending[depth] = 1  # what follows shows whether it was the body
}

function end_statement(    text, at) {
  if (kind[depth] == "class") {
    at = class[depth]
    text = simple(statement[depth])
    sub(/ +$/, "", text)
    if (text == "unnamed") {
      own[at] += own[inner]
    } else if (sub(/^(un)?named */, "", text)) {
      own[at] += text == "" ? 0 : declarators("a " text)
    } else {
      own[at] += declarators(text)
      if (!pending[depth]) functions[at] += functions_in(text, at)
    }
  }
  statement[depth] = ""
  pending[depth] = 0
}

function take(token) {
  if (token == "{") return open_brace()
  if (pending[depth]) {
    if (token != "," && token != ":") statement[depth] = ""  # otherwise a list of initialisers
    pending[depth] = 0
  }
  if (token == "}") return close_brace()
  if (token == ";") return end_statement()
  if (token == ":" && statement[depth] ~ /^(public|private|protected) $/) {
    statement[depth] = ""
  } else {
    statement[depth] = statement[depth] token " "
  }
}

FNR == 1 { depth = 0; kind[0] = "namespace"; statement[0] = ""; pending[0] = 0; until = "" }

{
  line = $0
  if (until == "" && (line ~ /^[ \t]*#/ || is_directive)) {
    is_directive = line ~ /\\$/
    next
  }
  while (line != "") {
    if (until != "") {  # in a comment or a raw string
      at = index(line, until)
      if (at == 0) next
      line = substr(line, at + length(until))
      until = ""
    } else if (match(line, /^[ \t]+/)) {
      line = substr(line, RLENGTH + 1)
    } else if (line ~ /^\/\//) {
      next
    } else if (line ~ /^\/\*/) {
      until = "*/"
      line = substr(line, 3)
    } else if (match(line, /^(u8|[uUL])?R"[^(]*\(/)) {
      until = substr(line, 1, RLENGTH - 1)
      sub(/^[^"]*"/, ")", until)
      until = until "\""
      line = substr(line, RLENGTH + 1)
      take("\"\"")
    } else if (match(line, /^"([^"\\]|\\.)*"/)) {
      line = substr(line, RLENGTH + 1)
      take("\"\"")
    } else if (match(line, /^'([^'\\]|\\.)*'/)) {
      line = substr(line, RLENGTH + 1)
      take("0")
    } else if (match(line, /^[0-9]([0-9A-Za-z_.]|'[0-9A-Fa-f])*/) || match(line, /^[A-Za-z_][A-Za-z0-9_]*/) ||
               match(line, /^(::|->|<<|<=|&&)/)) {
      token = substr(line, 1, RLENGTH)
      line = substr(line, RLENGTH + 1)
      take(token)
    } else {
      token = substr(line, 1, 1)
      line = substr(line, 2)
      take(token)
    }
  }
}

# ---- the sums ------------------------------------------------------------------------------------
function all_members(which, levels,    sum, names, count, i, other, largest, found) {
  sum = own[which]
  if (levels == 8) return sum  # two classes of one name seem to be bases of each other
  count = split(bases_of[which], names, ",")
  for (i = 1; i <= count; ++i) {
    found = names[i]
    if (found ~ /(^| )std ::/) continue
    gsub(/^ +| +$/, "", found)
    sub(/^.* /, "", found)
    largest = 0
    for (other = 1; other <= classes; ++other) {
      if (name_of[other] != found || other == which) continue
      if (all_members(other, levels + 1) > largest) largest = all_members(other, levels + 1)
    }
    sum += largest
  }
  return sum
}

END {
  for (each = 1; each <= classes; ++each) {
    members = all_members(each, 0)
    if (members > most) print file_of[each] ": " name_of[each] " has " members " data members"
    if (functions[each] > most_functions) print file_of[each] ": " name_of[each] " has " functions[each] " functions"
  }
  print classes " classes"
}
