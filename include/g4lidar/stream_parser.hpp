// SPDX-License-Identifier: MIT
// The streaming parser: bytes in, however they are cut; packets, replies and skipped bytes out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "g4lidar/bytes.hpp"
#include "g4lidar/frame_check.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/response.hpp"

namespace g4lidar {

/// Why bytes were skipped.
enum class skip_reason : std::uint8_t {
  noise,         ///< No frame begins here: boot text, the stray bytes that healthy devices send.
  bad_header,    ///< The start of a frame whose header or content is not possible.
  bad_checksum,  ///< A packet whole by its header; a byte of it is damaged or missing.
  truncated,     ///< A frame that had not ended when the input did.
};

/// Bytes of the stream that belong to no frame.
struct skipped {
  std::size_t count;
  skip_reason reason;

  friend constexpr bool operator==(const skipped&, const skipped&) = default;
};

/// What the parser finds. The views live until the parser or the input they lie in is touched.
using event = std::variant<packet_view, response_view, skipped>;

/// What stands at the front of some bytes.
enum class front_kind : std::uint8_t { packet, response, incomplete, skip };

/// The answer of what_stands_at_front().
struct front {
  front_kind kind;
  skip_reason reason;  ///< Of a skip; else noise.
  /// packet, response: the bytes of the frame. incomplete: as many are needed to tell. skip: how
  /// many to go on by; the bytes that a refused frame had claimed are in `claimed`.
  std::size_t size;
  std::size_t claimed;

  friend constexpr bool operator==(const front&, const front&) = default;
};

/// Whether `data[at]`, with the byte behind it if that is there, is the start of a frame. What is not
/// is noise. *Pure.*
[[nodiscard]] constexpr bool may_begin_frame(bytes data, std::size_t at) noexcept {
  const std::uint8_t first = data[at];
  if (first != packet_start[0] && first != response_start[0]) return false;
  const std::uint8_t second = first == packet_start[0] ? packet_start[1] : response_start[1];
  return at + 1 == data.size() || data[at + 1] == second;
}

/// The specification of the parser: what stands at the front of `data`, which is not empty. *Pure.*
///
/// Applied to a whole input from its first byte on, going on behind each frame and by `size` at each
/// skip, it gives the events that stream_parser gives for that input cut in any way. At a refused
/// start it goes on by one byte, so that a frame hidden behind the start is found. A skipped byte
/// that a refused frame had claimed counts with that frame's reason, until a frame begins.
[[nodiscard]] constexpr front what_stands_at_front(bytes data) noexcept {
  const bool maybe_packet = data[0] == packet_start[0];
  if (maybe_packet || data[0] == response_start[0]) {
    const frame_check check = maybe_packet ? check_packet(data) : check_response(data);
    switch (check.state) {
      case frame_state::valid:
        return {maybe_packet ? front_kind::packet : front_kind::response, skip_reason::noise,
                check.size, check.size};
      case frame_state::incomplete:
        return {front_kind::incomplete, skip_reason::noise, check.size, check.size};
      case frame_state::bad_checksum:
        return {front_kind::skip, skip_reason::bad_checksum, 1, check.size};
      case frame_state::bad_header:
        if (check.size <= 2) break;  // one byte that looked like a start is no header
        return {front_kind::skip, skip_reason::bad_header, 1, check.size};
    }
  }
  std::size_t noise = 1;
  while (noise < data.size() && !may_begin_frame(data, noise)) ++noise;
  return {front_kind::skip, skip_reason::noise, noise, noise};
}

/// The resynchronising parser. *Single thread, never allocates.* Constant memory: one frame of
/// carry; a frame that lies whole in the caller's bytes is viewed there.
///
/// At every moment: bytes in = bytes of frames + bytes skipped + held().
class stream_parser {
 public:
  /// The next event in `input`, which is shortened from its front by what was taken; nothing when
  /// all of it is taken. Then at most one unfinished frame is held for the next call. The views in
  /// an event live until the next call of any function here, and no longer than the input's bytes.
  [[nodiscard]] constexpr std::optional<event> next(bytes& input) & noexcept {
    while (true) {
      const bool in_place = held_ == 0;
      if (!in_place && !top_up(input)) return std::nullopt;
      const bytes data = in_place ? input : held_bytes();
      if (data.empty()) return std::nullopt;
      const front found = what_stands_at_front(data);
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
  /// The carry that views may point into would die with the parser.
  std::optional<event> next(bytes& input) && = delete;

  /// Pushes every event of `input` to `sink`; their views live as long as the call to it.
  template <class Sink>
  constexpr void feed(bytes input, Sink&& sink) {
    while (const auto found = next(input)) sink(*found);
  }

  /// Call this until it gives nothing when no more bytes will follow those so far: at the end of a
  /// file, after a stop, an unplug, or when the line has fallen silent. The held bytes are taken
  /// apart from one byte behind their false start on, so that a good frame among them is not lost.
  /// After that the parser is as new.
  [[nodiscard]] constexpr std::optional<event> finish() & noexcept {
    if (held_ == 0) {
      claim_ = {};
      return std::nullopt;
    }
    const bytes data = held_bytes();
    front found = what_stands_at_front(data);
    if (found.kind == front_kind::incomplete) {
      found = {front_kind::skip, skip_reason::truncated, 1, data.size()};
    }
    const std::size_t taken = settle(found);
    drop(taken);
    return make_event(found, taken, data);
  }
  std::optional<event> finish() && = delete;

  /// How many bytes of an unfinished frame are held, below max_packet_size.
  [[nodiscard]] constexpr std::size_t held() const noexcept { return held_; }

  /// At least so many more bytes are needed until there can be another event.
  [[nodiscard]] constexpr std::size_t missing() const noexcept {
    return needed_ > held_ ? needed_ - held_ : 1;
  }

 private:
  /// The bytes a refused frame had claimed and that are still to come.
  struct claim {
    std::size_t left = 0;
    skip_reason reason = skip_reason::noise;
  };

  [[nodiscard]] constexpr bytes held_bytes() const noexcept {
    return bytes(carry_).subspan(begin_, held_);
  }

  /// Fills the carry up to what the frame in it needs; false if the input does not suffice.
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

  /// Takes all of `input`, an unfinished frame, into the empty carry.
  constexpr void hold(bytes& input) noexcept {
    begin_ = 0;
    held_ = input.size();
    std::copy_n(input.begin(), held_, carry_.begin());
    input = {};
  }

  constexpr void drop(std::size_t count) noexcept {
    begin_ += count;
    held_ -= count;
    needed_ = 1;  // what is left may be anything
  }

  /// How many bytes the event for a front that is not `incomplete` takes. Keeps the claims of refused
  /// frames: a skip goes no further than the claim that it lies in.
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

  /// The event for a front of which `taken` bytes, by settle(), are its own. Made where the caller
  /// will read it: a copy of what was just written in pieces costs more than all the rest.
  [[nodiscard]] constexpr std::optional<event> make_event(const front& found, std::size_t taken,
                                                          bytes data) const noexcept {
    using made = std::optional<event>;
    const bytes frame = data.first(taken);
    if (found.kind == front_kind::packet) return made(std::in_place, packet_view(frame));
    if (found.kind == front_kind::response) return made(std::in_place, response_view(frame));
    return made(std::in_place, skipped{taken, claim_.reason});
  }

  std::array<std::uint8_t, max_packet_size> carry_{};
  std::size_t begin_ = 0;   // of the held bytes in the carry
  std::size_t held_ = 0;    // bytes of the carry in use
  std::size_t needed_ = 1;  // with fewer held bytes than this nothing new can be told
  claim claim_;
};

}  // namespace g4lidar
