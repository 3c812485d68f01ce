// SPDX-License-Identifier: MIT
// What a device sends that is no packet and no answer, in words for an error.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "text_signs.hpp"

namespace g4lidar {

/// Counts bytes, and keeps the first ones. *Single thread, never allocates.*
class unrecognised_bytes {
 public:
  /// As many characters as `text()` has at most.
  static constexpr std::size_t longest_text = 80;
  /// A text, by value.
  struct words {
    std::array<char, longest_text> characters{};
    std::size_t size = 0;

    // NOLINTNEXTLINE(google-explicit-constructor): it is a text.
    operator std::string_view() const noexcept { return {characters.data(), size}; }
    void add(std::string_view more) noexcept {
      const std::size_t count = std::min(more.size(), longest_text - size);
      std::copy_n(more.begin(), count, characters.begin() + static_cast<std::ptrdiff_t>(size));
      size += count;
    }
  };

  void sent(bytes command) noexcept { sent_.take(command); }
  void received(bytes data) noexcept { received_.take(data); }

  [[nodiscard]] std::uint64_t count() const noexcept { return received_.count; }

  /// ", 25 bytes like an answer of another length (A5 5A 15 00 00 00)"; empty if there were none.
  [[nodiscard]] words text() const noexcept {
    words made;
    if (received_.count == 0) return made;
    std::array<char, 20> digits{};
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), received_.count).ptr;
    made.add(", ");
    made.add({digits.data(), static_cast<std::size_t>(end - digits.data())});
    made.add(received_.count == 1 ? " byte" : " bytes");
    made.add(kind());
    made.add(" (");
    constexpr std::size_t most_shown = 6;
    constexpr std::string_view hex = "0123456789ABCDEF";
    const bytes shown = received_.first().first(std::min(received_.first().size(), most_shown));
    for (const std::uint8_t& each : shown) {
      if (&each != shown.data()) made.add(" ");
      made.add(hex.substr(each >> 4U, 1));
      made.add(hex.substr(each & 15U, 1));
    }
    made.add(")");
    return made;
  }

 private:
  struct beginning {
    std::array<std::uint8_t, 16> kept{};
    std::uint64_t count = 0;

    void take(bytes data) noexcept {
      const std::size_t have = first().size();
      const std::size_t more = std::min(data.size(), kept.size() - have);
      std::copy_n(data.begin(), more, kept.begin() + static_cast<std::ptrdiff_t>(have));
      count += data.size();
    }
    [[nodiscard]] bytes first() const noexcept {
      return bytes(kept).first(
          static_cast<std::size_t>(std::min<std::uint64_t>(count, kept.size())));
    }
  };

  [[nodiscard]] std::string_view kind() const noexcept {
    const bytes here = received_.first();
    const bytes ours = sent_.first();
    const std::size_t both = std::min(here.size(), ours.size());
    const bool is_echo = received_.count > 1 && received_.count <= sent_.count &&
                         std::ranges::equal(here.first(both), ours.first(both));
    if (is_echo) return ", an echo of what was sent";
    const auto begins_with = [here](bytes start) {
      return !std::ranges::search(here, start).empty();
    };
    if (begins_with(response_start)) return " like an answer of another length";
    if (begins_with(packet_start)) return " like damaged packets";
    const bool is_long = here.size() > 3;
    return is_long && std::ranges::all_of(here, is_of_text) ? " of text" : "";
  }

  beginning sent_;
  beginning received_;
};

}  // namespace g4lidar
