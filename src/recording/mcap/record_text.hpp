// SPDX-License-Identifier: MIT
// Records of an MCAP file, one field after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "format.hpp"
#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

/// A growing buffer. Allocates beyond the reserved size.
class record_text {
 public:
  template <class Number>
  void put(Number value) {
    static_assert(std::is_unsigned_v<Number>);
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      text_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
  }
  void put(bytes data) { text_.insert(text_.end(), data.begin(), data.end()); }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    text_.insert(text_.end(), text.begin(), text.end());
  }
  void put(const char* text) { put(std::string_view(text)); }

  /// Begins a record, or an array of bytes with its length as `Length` before it; pass the result
  /// to end().
  [[nodiscard]] std::size_t begin(opcode kind) {
    put(static_cast<std::uint8_t>(kind));
    return begin<std::uint64_t>();
  }
  template <class Length>
  [[nodiscard]] std::size_t begin() {
    put(Length{0});
    return text_.size();
  }
  template <class Length = std::uint64_t>
  void end(std::size_t begun) {
    set(begun - sizeof(Length), static_cast<Length>(text_.size() - begun));
  }
  /// Overwrites the bytes at `offset`.
  template <class Number>
  void set(std::size_t offset, Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      text_[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }

  void clear() noexcept { text_.clear(); }
  void reserve(std::size_t size) { text_.reserve(size); }
  [[nodiscard]] std::size_t size() const noexcept { return text_.size(); }
  [[nodiscard]] bytes all() const noexcept { return text_; }
  /// The buffer, for cdr_writer.
  [[nodiscard]] std::vector<std::uint8_t>& memory() noexcept { return text_; }

 private:
  std::vector<std::uint8_t> text_;
};

/// Fields of a record or a message, read one after the other. Missing fields are 0 and make
/// is_good() false.
class field_reader {
 public:
  explicit field_reader(bytes text) noexcept : text_(text) {}

  template <class Number>
  [[nodiscard]] Number take() noexcept {
    static_assert(std::is_unsigned_v<Number>);
    const bytes raw = take(sizeof(Number));
    Number value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value = static_cast<Number>(value | static_cast<Number>(Number{raw[i]} << (8 * i)));
    }
    return value;
  }
  [[nodiscard]] bytes take(std::uint64_t count) noexcept {
    if (count > text_.size() - at_) {
      is_good_ = false;
      at_ = text_.size();
      return {};
    }
    const bytes taken = text_.subspan(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }
  /// A string of MCAP: its length comes first.
  [[nodiscard]] std::string_view take_text() noexcept {
    const bytes raw = take(take<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  /// A string of CDR: aligned, with a terminating zero.
  [[nodiscard]] std::string_view take_cdr_text() noexcept {
    align(4);
    std::string_view text = take_text();
    if (!text.empty()) text.remove_suffix(1);
    return text;
  }
  /// Advances to the next multiple of `size` from the beginning.
  void align(std::size_t size) noexcept {
    const std::size_t over = at_ % size;
    if (over != 0) static_cast<void>(take(size - over));
  }
  [[nodiscard]] bool is_good() const noexcept { return is_good_; }
  [[nodiscard]] bool is_at_end() const noexcept { return at_ == text_.size(); }
  [[nodiscard]] bytes rest() const noexcept { return text_.subspan(at_); }

 private:
  bytes text_;
  std::size_t at_ = 0;
  bool is_good_ = true;
};

}  // namespace g4lidar::mcap
