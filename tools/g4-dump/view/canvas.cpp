// SPDX-License-Identifier: MIT
#include "canvas.hpp"

#include <algorithm>
#include <array>

namespace g4_tool {
namespace {

/// The dots of a braille cell, by row and column. (Unicode, Braille Patterns)
constexpr std::array<std::array<std::uint8_t, 2>, 4> braille_dots{
    {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}}};
constexpr char32_t braille_begin = 0x2800;

}  // namespace

canvas::canvas(int columns, int rows, glyphs glyphs)
    : columns_(std::max(columns, 0)),
      rows_(std::max(rows, 0)),
      how_(glyphs),
      places_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

void canvas::dot(int x, int y, ink colour) {
  if (x < 0 || y < 0 || !has(x / dots_across(), y / dots_down())) return;
  place& in = places_[index(x / dots_across(), y / dots_down())];
  const auto row = static_cast<std::size_t>(y % dots_down());
  const auto column = static_cast<std::size_t>(x % dots_across());
  const std::uint8_t bit = braille_dots.at(row).at(column);
  std::uint8_t& dots = colour == ink::grid ? in.grid : in.points;
  dots = static_cast<std::uint8_t>(dots | bit);
}

void canvas::write(int column, int row, std::string_view words, ink ink, cell_area within) {
  const int end = within.columns > 0 ? within.column + within.columns : columns_;
  for (const char letter : words) {
    if (column < end && has(column, row)) {
      place& in = places_[index(column, row)];
      in.word = letter >= ' ' && letter <= '~' ? letter : '?';
      in.what = ink;
    }
    ++column;
  }
}

canvas_cell canvas::at(int column, int row) const noexcept {
  if (!has(column, row)) return {};
  const place& in = places_[index(column, row)];
  if (in.word != '\0') return {static_cast<char32_t>(in.word), in.what};
  const std::uint8_t dots = in.points != 0 ? in.points : in.grid;
  if (dots == 0) return {};
  const ink what = in.points != 0 ? ink::points : ink::grid;
  if (how_ == glyphs::ascii) return {what == ink::points ? U'*' : U'.', what};
  return {braille_begin + dots, what};
}

std::string canvas::text(int row) const {
  std::string text;
  for (int column = 0; column < columns_; ++column) add_utf8(text, at(column, row).glyph);
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

void add_utf8(std::string& text, char32_t glyph) {
  if (glyph < 0x80) {
    text.push_back(static_cast<char>(glyph));
    return;
  }
  text.push_back(static_cast<char>(0xE0U | (glyph >> 12U)));
  text.push_back(static_cast<char>(0x80U | ((glyph >> 6U) & 0x3FU)));
  text.push_back(static_cast<char>(0x80U | (glyph & 0x3FU)));
}

}  // namespace g4_tool
