// SPDX-License-Identifier: MIT
#include "suggestion.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace g4_tool {
namespace {

/// How many letters must be inserted, removed, replaced or swapped with the next one to turn `a` into
/// `b`.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> two_ago;
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    two_ago = before;
    before = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + change});
      const bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swap) row[j] = std::min(row[j], two_ago[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::string lowered(std::string_view text) {
  std::string made(text);
  for (char& c : made) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return made;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 64;  // bounds the time of the comparison
  if (typed.size() < 3 || typed.size() > longest) return {};
  if (std::isdigit(static_cast<unsigned char>(typed.front())) != 0) return {};
  const std::string word = lowered(typed);
  std::size_t least = std::max<std::size_t>(1, typed.size() / 3) + 1;
  const std::string* nearest = nullptr;
  for (const std::string& each : known) {
    if (each == typed) return {};
    const bool is_begin = each.size() > word.size() && each.starts_with(word);
    const std::size_t distance = is_begin ? 1 : edit_distance(word, lowered(each));
    if (distance >= least) continue;
    least = distance;
    nearest = &each;
  }
  return nearest == nullptr ? "" : "; did you mean '" + *nearest + "'?";
}

}  // namespace g4_tool
