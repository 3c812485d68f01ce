// SPDX-License-Identifier: MIT
// Records of an MCAP file, and messages in CDR, written one field after the other.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "format.hpp"
#include "g4lidar/bytes.hpp"

namespace g4lidar::mcap {

/// Bytes that grow. Allocates beyond what was reserved.
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

  /// Begins a record, or an array of bytes with its length in a `Length` before it; give the result to
  /// end().
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
  /// Writes over what stands at `at`.
  template <class Number>
  void set(std::size_t at, Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      text_[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }

  void clear() noexcept { text_.clear(); }
  void reserve(std::size_t size) { text_.reserve(size); }
  void resize(std::size_t size) { text_.resize(size); }
  [[nodiscard]] std::size_t size() const noexcept { return text_.size(); }
  [[nodiscard]] bytes all() const noexcept { return text_; }
  [[nodiscard]] std::uint8_t* data() noexcept { return text_.data(); }

 private:
  std::vector<std::uint8_t> text_;
};

/// A message in CDR, little-endian: each number stands at a multiple of its size.
class cdr_text {
 public:
  /// Goes on behind what is in `text`.
  explicit cdr_text(record_text& text) : text_(text) {
    text_.put(std::uint32_t{0x00000100});  // the bytes 0, 1, 0, 0
    origin_ = text_.size();
  }
  template <class Number>
  void put(Number value) {
    if constexpr (std::is_floating_point_v<Number>) {
      put(std::bit_cast<std::uint32_t>(value));
    } else {
      align(sizeof(Number));
      text_.put(static_cast<std::make_unsigned_t<Number>>(value));
    }
  }
  void put(bytes data) {
    put(static_cast<std::uint32_t>(data.size()));
    text_.put(data);
  }
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    text_.put(bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    text_.put(std::uint8_t{0});
  }

 private:
  void align(std::size_t size) {
    while ((text_.size() - origin_) % size != 0) text_.put(std::uint8_t{0});
  }

  record_text& text_;
  std::size_t origin_;
};

/// The same read. What is not there is 0 and makes is_good() false.
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
  /// As MCAP has text: its length in front.
  [[nodiscard]] std::string_view take_text() noexcept {
    const bytes raw = take(take<std::uint32_t>());
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
  }
  /// As CDR has it: aligned, with a zero at its end.
  [[nodiscard]] std::string_view take_cdr_text() noexcept {
    align(4);
    std::string_view text = take_text();
    if (!text.empty()) text.remove_suffix(1);
    return text;
  }
  /// To the next multiple of `size` from the beginning.
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
