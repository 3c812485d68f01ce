// SPDX-License-Identifier: MIT
// Builds streams of packets, responses, noise and false starts, damages them, and remembers the
// undamaged units: packets and responses.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/packet_bytes.hpp"

namespace g4lidar::test {

/// Numbers from a seed, the same everywhere (splitmix64).
class dice {
 public:
  explicit dice(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  /// A number from 0 to `n` - 1; `n` is below 2^32.
  std::size_t below(std::size_t n) { return static_cast<std::uint32_t>(next() % n); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(next() & 0xFFU); }
  /// A byte that usually has a meaning for the parser.
  std::uint8_t structural_byte() {
    constexpr std::array<std::uint8_t, 16> structural{0xAA, 0x55, 0xAA, 0x55, 0xA5, 0x5A,
                                                      0x00, 0x01, 0x02, 0x03, 0x04, 0x05,
                                                      0x14, 0x40, 0x66, 0x81};
    return below(8) == 0 ? byte() : structural[below(structural.size())];
  }

 private:
  std::uint64_t state_;
};

/// The seed of a part of a stream, or of its damage: a kind, and a seed for the rest.
using recipe = std::pair<std::uint8_t, std::uint64_t>;

inline constexpr std::uint8_t part_kinds = 15;
inline constexpr std::uint8_t damage_kinds = 6;

/// A stretch of the damaged stream that is an unchanged unit.
struct intact_unit {
  std::size_t offset;
  std::size_t size;
};

/// A stream that is built from parts and then damaged.
class random_stream {
 public:
  void add(const recipe& part);
  void damage(const recipe& harm);

  /// The bytes. The checksums of false headers that must match are written here, last.
  [[nodiscard]] buffer data() const;
  /// The undamaged units, by their offsets in data().
  [[nodiscard]] std::vector<intact_unit> intact_units() const;

 private:
  struct cell {
    std::uint8_t value;
    int unit;           // the unit that it belongs to; -1: none, or damaged
    std::size_t index;  // its index in the unit
    bool seal;          // first byte of a header whose checksum must match
  };

  void add_bytes(const buffer& more) {
    for (const std::uint8_t byte : more) cells_.push_back({byte, -1, 0, false});
  }
  void add_unit(const buffer& unit) {
    const int id = static_cast<int>(sizes_.size());
    for (std::size_t i = 0; i < unit.size(); ++i) cells_.push_back({unit[i], id, i, false});
    sizes_.push_back(unit.size());
  }
  [[nodiscard]] static buffer packet(dice& random, std::size_t samples, unsigned ct);
  [[nodiscard]] static buffer response(dice& random);
  [[nodiscard]] static buffer time_packet(dice& random);
  [[nodiscard]] static buffer false_header(dice& random, std::size_t size);

  std::vector<cell> cells_;
  std::vector<std::size_t> sizes_;  // of the units
};

inline buffer random_stream::packet(dice& random, std::size_t samples, unsigned ct) {
  const bool structural = random.below(3) == 0;
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i < samples; ++i) {
    const unsigned low = structural ? random.structural_byte() : random.byte();
    const unsigned high = structural ? random.structural_byte() : random.byte();
    values.push_back(static_cast<std::uint16_t>(low | high << 8));
  }
  const auto first = static_cast<unsigned>(random.below(23040));
  const auto last = static_cast<unsigned>(random.below(4) == 0 ? random.below(23040) : first);
  return packet_bytes(ct, wire_angle(first), wire_angle(last), values);
}

inline buffer random_stream::response(dice& random) {
  switch (random.below(5)) {
    case 0:
      return response_bytes(5, 0x40, 0x81, {});
    case 1: {
      buffer content{random.structural_byte(), random.structural_byte(), random.byte(),
                     random.byte()};
      for (int i = 0; i < 16; ++i) content.push_back(static_cast<std::uint8_t>(random.below(10)));
      return response_bytes(20, 0, 4, content);
    }
    case 2:
      return response_bytes(
          3, 0, 6,
          {static_cast<std::uint8_t>(random.below(3)), random.structural_byte(), random.byte()});
    case 3:
      return response_bytes(1, 0, 4, {static_cast<std::uint8_t>(random.below(3))});
    default: {
      const std::size_t hundredths = random.below(2001);
      return response_bytes(4, 0, 4,
                            {static_cast<std::uint8_t>(hundredths % 256),
                             static_cast<std::uint8_t>(hundredths / 256), 0, 0});
    }
  }
}

inline buffer random_stream::time_packet(dice& random) {
  buffer out{0xAA, 0x66, 0xAA ^ 0x66};
  for (int i = 0; i < 5; ++i) {
    out.push_back(random.structural_byte());
    out[2] = static_cast<std::uint8_t>(out[2] ^ out.back());
  }
  return out;
}

/// The first bytes of a possible header, without a unit behind it.
inline buffer random_stream::false_header(dice& random, std::size_t size) {
  buffer out{0xAA, 0x55, random.byte(), static_cast<std::uint8_t>(1 + random.below(80))};
  append_u16(out, wire_angle(static_cast<unsigned>(random.below(23040))));
  append_u16(out, wire_angle(static_cast<unsigned>(random.below(23040))));
  append_u16(out, static_cast<unsigned>(random.below(65536)));
  out.resize(size);
  return out;
}

inline void random_stream::add(const recipe& part) {
  dice random(part.second);
  switch (part.first % part_kinds) {
    case 0:
    case 1:
      return add_unit(packet(random, 1 + random.below(80), 2U * random.byte() & 0xFFU));
    case 2:
      return add_unit(packet(random, 1, 1U | 2U * random.byte() % 256));
    case 3:
      return add_unit(packet(random, 1 + random.below(5), random.byte()));
    case 4:
      return add_unit(response(random));
    case 5: {
      buffer noise(1 + random.below(40));
      for (std::uint8_t& byte : noise) byte = random.byte();
      return add_bytes(noise);
    }
    case 6: {
      buffer noise(1 + random.below(20));
      for (std::uint8_t& byte : noise) byte = random.structural_byte();
      return add_bytes(noise);
    }
    case 7:
      return add_bytes(false_header(random, 2 + random.below(9)));
    case 8: {  // an incomplete response
      buffer reply = response(random);
      reply.resize(1 + random.below(reply.size()));
      return add_bytes(reply);
    }
    case 9: {  // an impossible response
      buffer reply = response(random);
      const std::size_t at = random.below(reply.size());
      const std::size_t more = random.below(2) == 0 ? 1 : 1 + random.below(255);
      reply[at] = static_cast<std::uint8_t>(reply[at] + more);
      return add_bytes(reply);
    }
    case 10: {  // an impossible packet, or one with a wrong checksum
      buffer bad = packet(random, 1 + random.below(20), random.byte());
      const std::size_t at = random.below(bad.size());
      bad[at] = static_cast<std::uint8_t>(bad[at] + 1 + random.below(255));
      return add_bytes(bad);
    }
    case 11: {  // a header with a matching checksum, whatever follows
      const std::size_t at = cells_.size();
      add_bytes(false_header(random, 10));
      cells_[at].seal = true;
      return;
    }
    case 12:
      return add_unit(time_packet(random));
    case 13: {  // an incomplete time packet, or one with a wrong checksum
      buffer bad = time_packet(random);
      bad[2] = static_cast<std::uint8_t>(bad[2] + random.below(2));
      bad.resize(1 + random.below(8));
      return add_bytes(bad);
    }
    default:
      return add_bytes({0x00});
  }
}

inline void random_stream::damage(const recipe& harm) {
  if (cells_.empty()) return;
  dice random(harm.second);
  const std::size_t at = random.below(cells_.size());
  const auto place = cells_.begin() + static_cast<std::ptrdiff_t>(at);
  const std::size_t length = std::min(1 + random.below(30), cells_.size() - at);
  switch (harm.first % damage_kinds) {
    case 0:  // a flipped bit
      place->value = static_cast<std::uint8_t>(place->value ^ 1U << random.below(8));
      place->unit = -1;
      return;
    case 1:  // one byte lost
      cells_.erase(place);
      return;
    case 2:  // some bytes lost
      cells_.erase(place, place + static_cast<std::ptrdiff_t>(length));
      return;
    case 3: {  // some additional bytes
      std::vector<cell> more;
      for (std::size_t i = 0; i < length; ++i)
        more.push_back({random.structural_byte(), -1, 0, false});
      cells_.insert(place, more.begin(), more.end());
      return;
    }
    case 4:  // a burst
      for (std::size_t i = at; i < at + length; ++i) cells_[i] = {random.byte(), -1, 0, false};
      return;
    default:  // the end is missing
      if (random.below(4) == 0) cells_.erase(place, cells_.end());
      return;
  }
}

inline buffer random_stream::data() const {
  buffer out;
  for (const cell& c : cells_) out.push_back(c.value);
  for (std::size_t at = cells_.size(); at-- > 0;) {
    const std::size_t left = cells_.size() - at;
    if (!cells_[at].seal || left < 10 || left < 10 + 2 * std::size_t{out[at + 3]}) continue;
    // The two bytes of a checksum that damage has moved onto a unit are not changed.
    if (cells_[at + 8].unit >= 0 || cells_[at + 9].unit >= 0) continue;
    const int sum = reference::checksum_of(reference::window(out, at));
    out[at + 8] = static_cast<std::uint8_t>(sum & 0xFF);
    out[at + 9] = static_cast<std::uint8_t>(sum >> 8);
  }
  return out;
}

inline std::vector<intact_unit> random_stream::intact_units() const {
  std::vector<intact_unit> intact;
  for (std::size_t at = 0; at < cells_.size(); ++at) {
    const int unit = cells_[at].unit;
    if (unit < 0 || cells_[at].index != 0) continue;
    const std::size_t size = sizes_[static_cast<std::size_t>(unit)];
    if (size > cells_.size() - at) continue;
    bool whole = true;
    for (std::size_t i = 0; i < size; ++i) {
      whole = whole && cells_[at + i].unit == unit && cells_[at + i].index == i;
    }
    if (whole) intact.push_back({at, size});
  }
  return intact;
}

}  // namespace g4lidar::test
