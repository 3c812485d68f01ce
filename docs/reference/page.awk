# SPDX-License-Identifier: MIT
# Makes a page of the reference from a document: each heading gets the name that links use, a
# different one in every document, and links to a heading use these names.
#   awk -f page.awk DOCUMENT

# A README is the page of its directory, and the first one is the main page.
function page_of(path,    parts, count) {
  if (path !~ /README\.md$/) {
    sub(/^.*\//, "", path)
    sub(/\.md$/, "", path)
    return tolower(path)
  }
  if (path == "README.md") path = document
  count = split(path, parts, "/")
  return count == 1 || parts[count - 1] == ".." ? "mainpage" : parts[count - 1]
}

# As in "When it is unplugged" -> "when-it-is-unplugged".
function name_of(heading) {
  heading = tolower(heading)
  gsub(/[^a-z0-9_ -]/, "", heading)
  gsub(/ /, "-", heading)
  return heading
}

# Links [words](file.md#heading) and [words](#heading).
function link(line,    done, place, file) {
  while (match(line, /\]\([A-Za-z0-9_.\/]*#[A-Za-z0-9_-]+\)/)) {
    place = substr(line, RSTART + 2, RLENGTH - 3)
    file = substr(place, 1, index(place, "#") - 1)
    sub(/^.*#/, "", place)
    if (file == "") file = document
    done = done substr(line, 1, RSTART + 1) "#" page_of(file) "_" place ")"
    line = substr(line, RSTART + RLENGTH)
  }
  return done line
}

FNR == 1 {
  document = FILENAME
  if (index(document, ENVIRON["PWD"] "/") == 1) document = substr(document, length(ENVIRON["PWD"]) + 2)
}
/^```/ { is_code = !is_code }
is_code { print; next }
/^#+ / {
  id = page_of(document) (titles++ ? "_" name_of(substr($0, index($0, " ") + 1)) : "")
  print $0 " {#" id "}"
  next
}
{ print link($0) }
