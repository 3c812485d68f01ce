# SPDX-License-Identifier: MIT
# awk -f list_number_functions.awk <header>...
#
# Prints "<header>: <name>" for each function of a header that takes a number: of the language, of std::chrono, or in a
# point, a scan, a pose, a twist, ... Members that are not public, and what the header only calls, are left out.

function without(text, pattern) {
  while (sub(pattern, " ", text)) {}
  return text
}

# The name and parameters of a declaration that ends here: "name ( ... )".
function declared(text, name, parameters) {
  text = without(text, "\\[\\[[^]]*\\]\\]")
  text = without(text, "noexcept *\\([^()]*\\)")
  text = without(text, "requires *\\(?[a-z_:<>&! ]*\\([^()]*\\)\\)?")
  if (text ~ /(^|[^a-z_])(return|if|for|while|switch|using|static_assert|typedef|operator)[^a-z_]/) return
  if (!match(text, /[a-z_0-9~]+ *\(/)) return
  name = substr(text, RSTART, RLENGTH - 1)
  gsub(/ /, "", name)
  if (substr(text, 1, RSTART - 1) ~ /[=.(]|->/) return
  parameters = substr(text, RSTART + RLENGTH)
  if (name ~ /^(~|noexcept|decltype|explicit|sizeof|alignas|defined|assert|G4LIDAR)/) return
  if (parameters ~ numbers) print header ": " name
}

BEGIN {
  numbers = "(^|[^a-z_])(float|double|int|unsigned|long|u?int(8|16|32|64)_t|size_t|milliseconds|seconds|nanoseconds|" \
            "Real|Number|point|xy_point|corner|pose|pose_2d|twist_2d|mounting|stamped_pose|stamped_odometry|decoded|arrival|" \
            "g4lidar_[a-z]*options|g4lidar_point|g4lidar_odometry|expected_rate|scan_frequency|[a-z_]*_limits|grid_options)" \
            "([^a-z_0-9]|$)"
}

FNR == 1 {
  header = FILENAME
  sub(/^.*include\/g4lidar\//, "", header)
  sub(/^.*include\//, "", header)
  statement = ""
  depth = scopes = comment = 0
  hidden[0] = 0
}

{
  line = $0
  sub(/\/\/.*/, "", line)
  gsub(/"([^"\\]|\\.)*"/, "\"\"", line)
  gsub(/'.'/, "0", line)
  gsub(/\/\*([^*]|\*+[^*\/])*\*+\//, " ", line)
  if (comment) {
    if (!sub(/.*\*\//, " ", line)) next
    comment = 0
  }
  if (sub(/\/\*.*/, " ", line)) comment = 1
  if (line ~ /^ *#/ || line ~ /\\$/) next
  for (i = 1; i <= length(line); ++i) {
    c = substr(line, i, 1)
    if (c == "{" || c == ";") {
      is_scope = statement ~ /(^|[^a-z_])(namespace|class|struct|union|extern|enum)([^a-z_]|$)/ && statement !~ /\(/
      if (depth == 0 && !hidden[scopes]) declared(statement)
      if (c == "{" && depth == 0 && is_scope) {
        is_private = statement ~ /(^|[^a-z_])class([^a-z_]|$)/ || statement ~ /namespace.*detail/
        hidden[scopes + 1] = hidden[scopes] || is_private
        base[scopes + 1] = hidden[scopes]
        ++scopes
      } else if (c == "{") {
        ++depth
      }
      statement = ""
    } else if (c == "}") {
      if (depth > 0) --depth
      else --scopes
      statement = ""
    } else if (c == ":" && statement ~ /(^| )(public|private|protected) *$/) {
      hidden[scopes] = base[scopes] || statement !~ /public/
      statement = ""
    } else {
      statement = statement c
    }
  }
  statement = statement " "
}
