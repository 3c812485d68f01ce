# SPDX-License-Identifier: MIT
# Makes of a header what Doxygen is to see of it.
# Hidden is what needs no words of its own: moves, destructors and comparisons that do what they always do, and
# what is deleted. Members of a struct whose names say all are shown without words. All that has words is left
# as it is.
#   awk -f header.awk HEADER

function is_usual(line) {
  return line ~ /\(const [a-z_]+&\) = delete;/ || line ~ /\) const&& = delete;/ ||
         line ~ / operator=\([a-z_]+&&\) noexcept;/ || line ~ /^ *[a-z_]+\([a-z_]+&&\) noexcept;/ ||
         line ~ /^ *(virtual )?~[a-z_]+\(\)( = default| override)?;/ || line ~ /^ *[a-z_]+\(\) = default;/ ||
         line ~ /friend (constexpr )?bool operator==\(/
}

# The members of a struct stand two blanks further in than its head, and have no parentheses.
function is_member(line, rest) {
  if (members == "" || substr(line, 1, length(members)) != members) return 0
  rest = substr(line, length(members) + 1)
  return rest ~ /^[a-zA-Z][^()]* [a-z0-9_]+( = [^;]*|\{[^;]*\})?;$/ &&
         rest !~ /^(using|friend|return|static|class|struct|enum|typedef) /
}

/^ *\/\/\// { is_told = 1; print; next }
/^ *struct [A-Za-z0-9_ ]*\{$/ {
  match($0, /^ */)
  members = substr($0, 1, RLENGTH) "  "
}
/^ *class / { members = "" }
!is_told && is_usual($0) {
  print "/** @cond */" $0
  is_hidden = $0 !~ /;$/
  if (!is_hidden) print "/** @endcond */"
  next
}
is_hidden && /;$/ { is_hidden = 0; print $0 "/** @endcond */"; next }
!is_told && is_member($0) { print $0 "  ///< &#8203;"; next }
{ is_told = 0; print }
