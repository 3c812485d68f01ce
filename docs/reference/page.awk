# SPDX-License-Identifier: MIT
# Makes a page of the reference from a document: each heading gets the name that links use, a
# different one in every document, and links to a heading use these names. Pictures are beside the pages.
#   awk -f page.awk DOCUMENT
# G4LIDAR_ONLY_PAGE names the only document of a reference: its links to other documents lead to those
# beside the reference, as a package installs them.

# The page of a path from the directory of the project. A README is the page of its directory, and the first one is the
# main page.
function page_of(path,    parts, count) {
  if (path == ENVIRON["G4LIDAR_ONLY_PAGE"] || path == "README.md") return "mainpage"
  count = split(tolower(path), parts, "/")
  if (parts[count] == "readme.md") return parts[count - 1]
  sub(/\.md$/, "", parts[count])
  return parts[count]
}

# As in "When it is unplugged" -> "when-it-is-unplugged".
function name_of(heading) {
  heading = tolower(heading)
  gsub(/[^a-z0-9_ -]/, "", heading)
  gsub(/ /, "-", heading)
  return heading
}

# A path relative to the document, from the directory of the project: "../README.md" of "docs/c.md".
function from_project(path,    place) {
  place = document
  sub(/[^\/]*$/, "", place)
  path = place path
  while (sub(/(^|\/)[^\/.]+\/\.\.\//, "/", path)) sub(/^\//, "", path)
  return path
}

# Links [words](file.md), [words](file.md#heading) and [words](#heading); of [words](LICENSE) the words.
function link(line,    done, place, file) {
  while (match(line, /\[[^][]*\]\(LICENSE\)/)) {
    place = substr(line, RSTART + 1, RLENGTH - length("[](LICENSE)"))
    line = substr(line, 1, RSTART - 1) place substr(line, RSTART + RLENGTH)
  }
  while (match(line, /\]\(([A-Za-z0-9_.\/-]+\.md)?(#[A-Za-z0-9_-]+)?\)/)) {
    place = substr(line, RSTART + 2, RLENGTH - 3)
    if (place == "") { # []() of C++
      done = done substr(line, 1, RSTART + 2)
      line = substr(line, RSTART + RLENGTH)
      continue
    }
    file = place
    sub(/#.*$/, "", file)
    file = file == "" ? document : from_project(file)
    place = place ~ /#/ ? "_" substr(place, index(place, "#") + 1) : ""
    done = done substr(line, 1, RSTART + 1) "#" page_of(file) place ")"
    line = substr(line, RSTART + RLENGTH)
  }
  return done line
}

# Pictures ![words](docs/scan.svg) and <img src="docs/scan.svg">.
function picture(line,    done, found) {
  while (match(line, /(\]\(|src=")[A-Za-z0-9_.\/-]+\.(png|svg)[)"]/)) {
    found = substr(line, RSTART, RLENGTH)
    sub(/\(.*\//, "(", found)
    sub(/".*\//, "\"", found)
    done = done substr(line, 1, RSTART - 1) found
    line = substr(line, RSTART + RLENGTH)
  }
  return done line
}

# Links [words](file.md) and [words](file.md#heading) to documents that are no pages.
function link_to_others(line,    done, words, place) {
  while (match(line, /\[[^][]*\]\([A-Za-z0-9_.\/]+\.md(#[A-Za-z0-9_-]+)?\)/)) {
    words = substr(line, RSTART + 1, RLENGTH - 2)
    place = words
    sub(/^.*\]\(/, "", place)
    sub(/\]\(.*$/, "", words)
    done = done substr(line, 1, RSTART - 1) "<a href=\"../" from_project(place) "\">" words "</a>"
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
{
  line = picture($0)
  if (ENVIRON["G4LIDAR_ONLY_PAGE"] != "") line = link_to_others(line)
  print link(line)
}
