// SPDX-License-Identifier: MIT
// The streaming parser: bytes in, divided in any way; packets, responses, time packets and skipped
// bytes out.
// Resynchronises after damage.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_counts.hpp"

namespace g4lidar {

/// What the parser finds. The views are valid until the next call of the parser, and as long as the
/// input.
using event =
    std::variant<packet_view, response_view, skipped, time_packet_view, empty_packet_view>;

/// How many bytes of the stream an event is. *Pure.*
[[nodiscard]] constexpr std::size_t size_of(const event& found) noexcept {
  if (const auto* packet = std::get_if<packet_view>(&found)) return packet->data().size();
  if (const auto* response = std::get_if<response_view>(&found)) return response->data().size();
  if (const auto* gone = std::get_if<skipped>(&found)) return gone->count;
  if (const auto* time = std::get_if<time_packet_view>(&found)) return time->data().size();
  const auto* empty = std::get_if<empty_packet_view>(&found);
  return empty == nullptr ? 0 : empty->data().size();
}

/// What `data` begins with.
enum class front_kind : std::uint8_t {
  packet,
  response,
  incomplete,
  skip,
  time_packet,
  empty_packet
};

/// The result of what_stands_at_front().
struct front {
  front_kind kind;
  skip_reason reason;  ///< For a skip; else noise.
  /// packet, response, time packet, empty packet: its size. incomplete: the number of bytes needed to decide.
  /// skip: how many bytes to skip; `claimed` has the size by the refused header.
  std::size_t size;
  std::size_t claimed;

  friend constexpr bool operator==(const front&, const front&) = default;
};

/// Whether `data[at]`, with the next byte if it is available, may start one of these. Others
/// are noise. *Pure.*
[[nodiscard]] constexpr bool may_be_start(bytes data, std::size_t offset) noexcept {
  const std::uint8_t first = data[offset];
  if (first != packet_start[0] && first != response_start[0]) return false;
  if (offset + 1 == data.size()) return true;
  if (first == response_start[0]) return data[offset + 1] == response_start[1];
  return data[offset + 1] == packet_start[1] || data[offset + 1] == time_packet_start[1];
}

namespace detail {

/// Whether `data`, whose first byte is AA, begins with a packet or a time packet. *Pure.* Not
/// inlined: otherwise compilers spend 50 instructions more on each byte that arrives alone.
[[nodiscard, gnu::noinline]] constexpr wire_check check_aa(bytes data,
                                                           sample_format format) noexcept {
  static_assert(packet_start[0] == time_packet_start[0]);
  const bool is_time = data.size() > 1 && data[1] == time_packet_start[1];
  return is_time ? check_time_packet(data) : check_packet(data, format);
}

/// The kind of a valid front. *Pure.*
[[nodiscard]] constexpr front_kind kind_of_front(bytes data) noexcept {
  if (data[0] == response_start[0]) return front_kind::response;
  if (data[1] != packet_start[1]) return front_kind::time_packet;
  return data[3] != 0 ? front_kind::packet : front_kind::empty_packet;
}

}  // namespace detail

/// The specification of the parser: what `data`, which is not empty, begins with. *Pure.*
///
/// Applied to a complete input from its first byte, with a step behind each packet, response and
/// time packet and by `size` at each skip, it gives the same events as stream_parser for that input,
/// divided in any way. At a refused start the step is one byte, so that a packet hidden behind the
/// start is found. A skipped byte that a refused start had claimed has the reason of that start,
/// until a valid one begins. `format` is that of the packets.
[[nodiscard]] constexpr front what_stands_at_front(bytes data,
                                                   sample_format format = g4_format) noexcept {
  const bool maybe_packet = data[0] == packet_start[0];
  if (maybe_packet || data[0] == response_start[0]) {
    const wire_check check =
        maybe_packet ? detail::check_aa(data, format)
                     : check_response(data, format.has_angle_replies, format.largest_byte_reply);
    switch (check.state) {
      case wire_state::valid:
        return {detail::kind_of_front(data), skip_reason::noise, check.size, check.size};
      case wire_state::incomplete:
        return {front_kind::incomplete, skip_reason::noise, check.size, check.size};
      case wire_state::bad_checksum:
        return {front_kind::skip, skip_reason::bad_checksum, 1, check.size};
      case wire_state::bad_header:
        if (check.size <= 2) break;  // one byte that looks like a start is no header
        return {front_kind::skip, skip_reason::bad_header, 1, check.size};
    }
  }
  std::size_t noise = 1;
  while (noise < data.size() && !may_be_start(data, noise)) ++noise;
  return {front_kind::skip, skip_reason::noise, noise, noise};
}

/// The resynchronising parser. *Single thread, never allocates.* Constant memory: a carry of one
/// packet or response; one that is complete in the caller's bytes is viewed there.
///
/// At every moment: bytes in = bytes of packets, responses and time packets + bytes skipped + held().
class stream_parser {
 public:
  /// For packets of this format; packets of another one, or longer than max_packet_size, are skipped and
  /// counted.
  explicit constexpr stream_parser(sample_format format = g4_format) noexcept : format_(format) {
    constexpr std::size_t room = max_packet_size - packet_header_size;
    const std::size_t most = room / sample_size(format.layout);
    format_.max_samples =
        static_cast<std::uint8_t>(std::min<std::size_t>(format.max_samples, most));
  }

  /// Packets are of this layout from now on. Its samples have the size of those before.
  constexpr void set_layout(sample_layout layout) noexcept {
    assert(sample_size(layout) == sample_size(format_.layout));
    format_.layout = layout;
  }

  /// The next event in `input`. Removes the taken bytes from the front of `input`. Returns nothing
  /// when all of it is taken; then at most one unfinished packet or response is held for the next call. The
  /// views in an event are valid until the next call of any function, and at most as long as the
  /// bytes of the input.
  [[nodiscard]] constexpr std::optional<event> next(bytes& input) & noexcept {
    while (true) {
      const bool in_place = held_ == 0;
      if (!in_place && !top_up(input)) return std::nullopt;
      const bytes data = in_place ? input : held_bytes();
      if (data.empty()) return std::nullopt;
      const front found = what_stands_at_front(data, format_);
      if (found.kind == front_kind::incomplete) {
        if (in_place) hold(input);
        needed_ = found.size;
        continue;
      }
      const std::size_t taken = settle(found);
      if (in_place) {
        input = input.subspan(taken);
      } else {
        drop(taken);
      }
      return make_event(found, taken, data);
    }
  }
  /// Deleted: views may point into the carry, which is destroyed with the parser.
  std::optional<event> next(bytes& input) && = delete;

  /// Passes every event of `input` to `sink`; the views are valid during that call.
  template <class Sink>
  constexpr void feed(bytes input, Sink&& sink) {
    while (const auto found = next(input)) sink(*found);
  }

  /// Call this until it returns nothing when no more bytes follow: at the end of a file, after a
  /// stop, an unplug, or when bytes have stopped arriving. The held bytes are parsed again from one
  /// byte behind their false start, so that a valid packet among them is not lost. After that the
  /// parser is as after construction.
  [[nodiscard]] constexpr std::optional<event> finish() & noexcept {
    if (held_ == 0) {
      claim_ = {};
      return std::nullopt;
    }
    const bytes data = held_bytes();
    front found = what_stands_at_front(data, format_);
    if (found.kind == front_kind::incomplete) {
      found = {front_kind::skip, skip_reason::truncated, 1, data.size()};
    }
    const std::size_t taken = settle(found);
    drop(taken);
    return make_event(found, taken, data);
  }
  std::optional<event> finish() && = delete;

  /// The number of held bytes of an unfinished packet or response, below max_packet_size.
  [[nodiscard]] constexpr std::size_t held() const noexcept { return held_; }

  /// The least number of further bytes until there can be another event.
  [[nodiscard]] constexpr std::size_t missing() const noexcept {
    return needed_ > held_ ? needed_ - held_ : 1;
  }

 private:
  /// The bytes claimed by a refused start that have not been processed yet.
  struct claim {
    std::size_t left = 0;
    skip_reason reason = skip_reason::noise;
  };

  [[nodiscard]] constexpr bytes held_bytes() const noexcept {
    return bytes(carry_).subspan(begin_, held_);
  }

  /// Fills the carry up to the size that it needs; false if the input is not sufficient.
  constexpr bool top_up(bytes& input) noexcept {
    if (held_ >= needed_) return true;
    if (begin_ + needed_ > carry_.size()) {
      std::copy_n(carry_.begin() + static_cast<std::ptrdiff_t>(begin_), held_, carry_.begin());
      begin_ = 0;
    }
    const std::size_t count = std::min(needed_ - held_, input.size());
    std::copy_n(input.begin(), count, carry_.begin() + static_cast<std::ptrdiff_t>(begin_ + held_));
    held_ += count;
    input = input.subspan(count);
    return held_ >= needed_;
  }

  /// Moves all of `input`, an unfinished packet or response, to the empty carry.
  constexpr void hold(bytes& input) noexcept {
    begin_ = 0;
    held_ = input.size();
    std::copy_n(input.begin(), held_, carry_.begin());
    input = {};
  }

  constexpr void drop(std::size_t count) noexcept {
    begin_ += count;
    held_ -= count;
    needed_ = 1;  // the rest may be anything
  }

  /// How many bytes the event for a front that is not `incomplete` takes. Keeps the claims of
  /// refused starts: a skip ends with the claim that contains it.
  [[nodiscard]] constexpr std::size_t settle(const front& found) noexcept {
    if (found.kind != front_kind::skip) {
      claim_ = {};
      return found.size;
    }
    if (claim_.left == 0) claim_ = {found.claimed, found.reason};
    const std::size_t count = std::min(found.size, claim_.left);
    claim_.left -= count;
    return count;
  }

  /// The event for a front of which `taken` bytes, by settle(), belong to it. Constructed in the
  /// place where the caller reads it: a copy of a value just written in pieces costs more than the
  /// rest.
  [[nodiscard]] constexpr std::optional<event> make_event(const front& found, std::size_t taken,
                                                          bytes data) const noexcept {
    using made = std::optional<event>;
    const bytes whole = data.first(taken);
    if (found.kind == front_kind::packet)
      return made(std::in_place, packet_view(whole, format_.layout));
    if (found.kind == front_kind::response) return made(std::in_place, response_view(whole));
    if (found.kind == front_kind::time_packet) return made(std::in_place, time_packet_view(whole));
    if (found.kind == front_kind::empty_packet)
      return made(std::in_place, empty_packet_view(whole));
    return made(std::in_place, skipped{taken, claim_.reason, data[taken - 1]});
  }

  std::array<std::uint8_t, max_packet_size> carry_{};
  std::size_t begin_ = 0;   // of the held bytes in the carry
  std::size_t held_ = 0;    // bytes of the carry in use
  std::size_t needed_ = 1;  // with fewer held bytes than this nothing new can be decided
  claim claim_;
  sample_format format_;
};

}  // namespace g4lidar
