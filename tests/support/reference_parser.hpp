// SPDX-License-Identifier: MIT
// The expected results of the parser for a complete input, written independently: without code of
// the library, byte by byte and without regard to speed. The tests compare with it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace reference {

/// The kind of a stretch of the input.
enum class kind {
  packet,
  response,
  time_packet,
  empty_packet,
  noise,
  bad_header,
  bad_checksum,
  truncated
};

/// A stretch of the input: a packet, a response, a time packet, or neighbouring skipped bytes of one reason.
struct stretch {
  std::size_t offset;
  std::size_t size;
  kind what;

  friend bool operator==(const stretch&, const stretch&) = default;
};

[[nodiscard]] inline std::string name_of(kind what) {
  switch (what) {
    case kind::packet:
      return "packet";
    case kind::response:
      return "response";
    case kind::time_packet:
      return "time_packet";
    case kind::empty_packet:
      return "empty_packet";
    case kind::noise:
      return "noise";
    case kind::bad_header:
      return "bad_header";
    case kind::bad_checksum:
      return "bad_checksum";
    case kind::truncated:
      return "truncated";
  }
  return "?";
}

/// For GoogleTest's messages.
template <class Stream>
Stream& operator<<(Stream& out, const stretch& s) {
  out << "[" << s.offset << ", +" << s.size << " " << name_of(s.what) << "]";
  return out;
}

/// A part of an input by its offset; bytes behind its end are missing.
class window {
 public:
  window(const std::vector<std::uint8_t>& input, std::size_t from) : input_(input), from_(from) {}

  [[nodiscard]] std::size_t left() const { return input_.size() - from_; }
  /// Byte `i`, or -1 behind the end of the input.
  [[nodiscard]] int operator[](std::size_t i) const {
    return i < left() ? static_cast<int>(input_[from_ + i]) : -1;
  }

 private:
  const std::vector<std::uint8_t>& input_;
  std::size_t from_;
};

/// What the packets of a model contain.
struct packet_form {
  std::size_t sample_bytes = 2;
  int most_samples = 80;
};

/// Whether some valid packet header begins with the first `k` bytes, 1 <= k <= 8. Missing bytes are
/// assumed to be favourable: a missing upper byte of an angle counts as 0.
[[nodiscard]] inline bool could_be_packet(const window& in, std::size_t k, int most_samples = 80) {
  const auto angle_ok = [&](std::size_t low) {
    if (k <= low) return true;
    const int high = k > low + 1 ? in[low + 1] : 0;
    const int raw = in[low] + 256 * high;
    return raw % 2 == 1 && raw / 2 < 360 * 64;
  };
  return in[0] == 0xAA && (k < 2 || in[1] == 0x55) && (k < 4 || in[3] <= most_samples) &&
         angle_ok(4) && angle_ok(6);
}

/// The checksum in the order of the protocol page: PH, FSA, the samples, CT with LSN, LSA. Of a sample
/// of 3 bytes the first one is a word alone.
[[nodiscard]] inline int checksum_of(const window& in, std::size_t sample_bytes = 2) {
  const auto word = [&](std::size_t i) { return in[i] + 256 * in[i + 1]; };
  int sum = 0x55AA;
  sum ^= word(4);
  for (int sample = 0; sample < in[3]; ++sample) {
    const std::size_t at = 10 + sample_bytes * static_cast<std::size_t>(sample);
    if (sample_bytes == 3) sum ^= in[at];
    if (sample_bytes == 4) sum ^= word(at);
    sum ^= word(at + sample_bytes - 2);
  }
  sum ^= in[2] + 256 * in[3];
  sum ^= word(6);
  return sum;
}

/// Whether some valid response begins with the first `k` bytes.
[[nodiscard]] inline bool could_be_response(const window& in, std::size_t k) {
  struct form {
    int length, top_bits, type, content;
  };
  const form forms[] = {{5, 0x40, 0x81, 0},
                        {20, 0x00, 0x04, 20},
                        {3, 0x00, 0x06, 3},
                        {1, 0x00, 0x04, 1},
                        {4, 0x00, 0x04, 4}};
  for (const form& f : forms) {
    const int header[7] = {0xA5, 0x5A, f.length, 0, 0, f.top_bits, f.type};
    bool fits = k <= 7 + static_cast<std::size_t>(f.content);
    for (std::size_t i = 0; i < 7 && i < k; ++i) fits = fits && in[i] == header[i];
    const auto content = [&](std::size_t i) { return 7 + i < k ? in[7 + i] : 0; };
    if (f.content == 1 || f.content == 3) fits = fits && content(0) <= 2;
    if (f.content == 4) {
      const std::int64_t hundredths =
          content(0) + 256LL * content(1) + 65536LL * content(2) + 16777216LL * content(3);
      fits = fits && hundredths <= 2000;
    }
    if (f.content == 20) {
      for (std::size_t i = 4; i < 20; ++i) fits = fits && content(i) <= 9;
    }
    if (fits) return true;
  }
  return false;
}

/// What begins at one offset of the input, without its context.
struct start {
  enum { no_start, refused, unfinished, valid } state;
  kind what;  ///< Of a valid one: a packet of any kind or a response. Refused: the reason.
  std::size_t
      size;  ///< Of a valid one; refused: the bytes from the start to the first impossible one.
};

[[nodiscard]] inline start packet_start_at(const window& in, packet_form form) {
  for (std::size_t k = 1; k <= 8; ++k) {
    if (k > in.left()) return {start::unfinished, kind::truncated, 0};
    if (!could_be_packet(in, k, form.most_samples)) {
      if (k <= 2) return {start::no_start, kind::noise, 1};
      return {start::refused, kind::bad_header, k};
    }
  }
  const std::size_t size = 10 + form.sample_bytes * static_cast<std::size_t>(in[3]);
  if (size > in.left()) return {start::unfinished, kind::truncated, 0};
  if (checksum_of(in, form.sample_bytes) != in[8] + 256 * in[9])
    return {start::refused, kind::bad_checksum, size};
  return {start::valid, in[3] == 0 ? kind::empty_packet : kind::packet, size};
}

[[nodiscard]] inline start response_start_at(const window& in) {
  std::size_t k = 1;
  while (k <= in.left() && could_be_response(in, k)) {
    // A response is complete when nothing can follow: no response is the beginning of another.
    const int length = k >= 7 ? (in[2] == 5 ? 0 : in[2]) : -1;
    if (length >= 0 && k == 7 + static_cast<std::size_t>(length)) {
      return {start::valid, kind::response, k};
    }
    ++k;
  }
  if (k > in.left()) return {start::unfinished, kind::truncated, 0};
  if (k <= 2) return {start::no_start, kind::noise, 1};
  return {start::refused, kind::bad_header, k};
}

/// AA 66, a checksum that is the exclusive or of the other seven bytes, four bytes of time, and one more.
[[nodiscard]] inline start time_packet_start_at(const window& in) {
  if (in.left() < 8) return {start::unfinished, kind::truncated, 0};
  int sum = 0;
  for (std::size_t i = 0; i < 8; ++i) sum ^= i == 2 ? 0 : in[i];
  if (sum != in[2]) return {start::refused, kind::bad_checksum, 8};
  return {start::valid, kind::time_packet, 8};
}

[[nodiscard]] inline start start_at(const std::vector<std::uint8_t>& input, std::size_t offset,
                                    packet_form form = {}) {
  const window in(input, offset);
  if (in[0] == 0xAA && in[1] == 0x66) return time_packet_start_at(in);
  if (in[0] == 0xAA) return packet_start_at(in, form);
  if (in[0] == 0xA5) return response_start_at(in);
  return {start::no_start, kind::noise, 1};
}

/// The complete input, parsed.
struct reading {
  std::vector<stretch> stretches;  ///< From the first byte to the last, without a gap.
  std::size_t held_from;           ///< The bytes from here on are reported by finish() only.
};

/// Parses `input` from its first byte to its last, with finish() at the end. Each byte is part of a
/// packet or response, or has a reason. A refused start gives its reason to all bytes that it
/// claimed, unless an earlier one claimed them before, and until a valid one begins.
[[nodiscard]] inline reading read(const std::vector<std::uint8_t>& input, packet_form form = {}) {
  reading result{{}, input.size()};
  bool ended = false;  // the input is not sufficient to decide: from here on finish() decides
  std::size_t claimed_up_to = 0;
  kind claimed_for = kind::noise;
  const auto add = [&](std::size_t offset, std::size_t size, kind what, bool mergeable) {
    if (mergeable && !result.stretches.empty() && result.stretches.back().what == what) {
      result.stretches.back().size += size;
    } else {
      result.stretches.push_back({offset, size, what});
    }
  };
  for (std::size_t at = 0; at < input.size();) {
    const start s = start_at(input, at, form);
    if (s.state == start::unfinished && !ended) {
      ended = true;
      result.held_from = at;
    }
    if (s.state == start::valid) {
      add(at, s.size, s.what, false);
      at += s.size;
      claimed_up_to = at;
      continue;
    }
    if (at >= claimed_up_to) {
      claimed_for = s.what;
      claimed_up_to = s.state == start::unfinished ? input.size() : at + s.size;
    }
    add(at, 1, claimed_for, true);
    ++at;
  }
  return result;
}

}  // namespace reference
