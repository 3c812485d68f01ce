# SPDX-License-Identifier: MIT
# The links of Markdown documents that lead nowhere: a file that is missing, or a heading that its document does not have.
#   awk -f links.awk DOCUMENT...

# is_there(path): whether there is such a file or directory.
function is_there(path) {
  if (!(path in known)) known[path] = system("test -e '" path "'") == 0
  return known[path]
}

# name_of(heading): as in "When it is unplugged" -> "when-it-is-unplugged".
function name_of(heading) {
  gsub(/\]\([^)]*\)/, "", heading)
  heading = tolower(heading)
  gsub(/[][!-,.\/:-@^`{-~]/, "", heading)
  gsub(/ /, "-", heading)
  return heading
}

# read_headings(path): once, into headings[path, name].
function read_headings(path,    line, code, name, times) {
  if (path in has_read) return
  has_read[path] = 1
  while ((getline line <path) > 0) {
    if (line ~ /^```/) code = !code
    if (code || line !~ /^#+ /) continue
    name = name_of(substr(line, index(line, " ") + 1))
    times = seen[path, name]++
    headings[path, times ? name "-" times : name] = 1
  }
  close(path)
}

function fault(text) {
  printf "%s:%d: %s\n", FILENAME, FNR, text
  found = 1
}

# follow(link): from the document that is being read.
function follow(link,    path, heading) {
  if (link ~ /^[a-z]+:/) return # of the web
  path = link
  sub(/#.*$/, "", path)
  heading = index(link, "#") ? substr(link, index(link, "#") + 1) : ""
  if (path == "") {
    path = FILENAME
  } else if (FILENAME ~ /\//) {
    path = directory path
    while (path ~ /[^\/]+\/\.\.\//) {
      if (!match(path, /[^\/.]+[^\/]*\/\.\.\//)) break
      path = substr(path, 1, RSTART - 1) substr(path, RSTART + RLENGTH)
    }
  }
  if (!is_there(path)) {
    fault("a link to " link ", which is not there")
  } else if (heading != "") {
    read_headings(path)
    if (!((path, heading) in headings)) fault("a link to " link ", a heading that is not there")
  }
}

FNR == 1 {
  directory = FILENAME
  sub(/[^\/]*$/, "", directory)
  is_code = 0
}
/^```/ { is_code = !is_code }
is_code { next }
{
  line = $0
  gsub(/`[^`]*`/, "", line)
  while (match(line, /\]\([^) ]+\)|src="[^"]+"/)) {
    part = substr(line, RSTART, RLENGTH)
    line = substr(line, RSTART + RLENGTH)
    sub(/^(\]\(|src=")/, "", part)
    sub(/[)"]$/, "", part)
    follow(part)
  }
}
END { exit found }
