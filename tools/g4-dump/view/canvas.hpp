// SPDX-License-Identifier: MIT
// A picture of character cells: dots as braille or ASCII, and text above them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// The form of the dots: eight in a cell, or two, one above the other.
enum class glyphs : unsigned char { braille, ascii };

/// What a cell shows; it determines the colour.
enum class ink : unsigned char { plain, faint, grid, points, good, warn, bad, title };
inline constexpr std::size_t ink_count = static_cast<std::size_t>(ink::title) + 1;

/// A rectangle of cells.
struct cell_area {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

struct canvas_cell {
  char32_t glyph = U' ';
  ink what = ink::plain;

  friend bool operator==(const canvas_cell&, const canvas_cell&) = default;
};

/// Drawing outside of it has no effect. Text hides dots, and points hide the grid.
class canvas {
 public:
  canvas(int columns, int rows, glyphs glyphs);

  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  /// Dots of a cell, from left to right and from top to bottom. Dots are square if a cell is twice as high
  /// as it is wide.
  [[nodiscard]] int dots_across() const noexcept { return how_ == glyphs::braille ? 2 : 1; }
  [[nodiscard]] int dots_down() const noexcept { return how_ == glyphs::braille ? 4 : 2; }

  /// Draws a dot of the grid or a point; x and y count dots from the left and from the top.
  void dot(int x, int y, ink ink);
  /// Writes ASCII text, cut at the edge of `within` (empty: the whole canvas).
  void write(int column, int row, std::string_view words, ink ink, cell_area within = {});

  [[nodiscard]] canvas_cell at(int column, int row) const noexcept;
  /// A row in UTF-8 without trailing blanks.
  [[nodiscard]] std::string text(int row) const;

 private:
  struct place {
    char word = '\0';
    ink what = ink::plain;
    std::uint8_t grid = 0;  // the dots, as bits of a braille pattern
    std::uint8_t points = 0;
  };
  [[nodiscard]] bool has(int column, int row) const noexcept {
    return column >= 0 && column < columns_ && row >= 0 && row < rows_;
  }
  [[nodiscard]] std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  int columns_;
  int rows_;
  glyphs how_;
  std::vector<place> places_;
};

/// Appends `glyph` in UTF-8.
void add_utf8(std::string& text, char32_t glyph);

}  // namespace g4_tool
