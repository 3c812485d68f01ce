# SPDX-License-Identifier: MIT
# Prepares a header for Doxygen.
# Hides declarations that need no description: moves, destructors and comparisons with the usual
# behaviour, and deleted functions. Members of a struct with self-explanatory names are shown
# without a description. Declarations with a description are not changed.
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

# Specialisations of templates of other libraries, completely.
/^template <>$/ { is_held = 1; next }
is_held {
  is_held = 0
  is_foreign = $0 ~ /bool std::/
  print (is_foreign ? "/** @cond */" : "") "template <>"
}
is_foreign {
  is_foreign = $0 !~ /^[^ ].*;$/
  print $0 (is_foreign ? "" : "/** @endcond */")
  next
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
