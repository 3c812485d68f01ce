// SPDX-License-Identifier: MIT
#include "change_signs.hpp"

#include <algorithm>

#include "g4lidar/core/packet.hpp"

namespace g4lidar {
namespace {

constexpr std::uint8_t interpret = 0xFF;  // begins each command of telnet
constexpr std::uint8_t tab = 0x09;
constexpr std::uint8_t line_feed = 0x0A;
constexpr std::uint8_t carriage_return = 0x0D;
constexpr std::uint8_t xon = 0x11;
constexpr std::uint8_t xoff = 0x13;
constexpr std::uint8_t blank = 0x20;
/// Fewer signs may be chance.
constexpr std::uint64_t few = 8;

/// What a terminal takes or changes: one by one, or both. In angles and checksums each is as frequent as any other odd byte.
constexpr std::array<std::uint8_t, 3> taken_alone{0x03, tab, carriage_return};
constexpr std::array<std::array<std::uint8_t, 2>, 2> taken_together{{{xon, xoff}, {0x15, 0x17}}};
/// Odd control characters that nothing takes.
constexpr std::array<std::uint8_t, 7> usual_controls{0x05, 0x07, 0x0B, 0x19, 0x1B, 0x1D, 0x1F};
/// So many of each usual one, for each that is absent: then the absence is no chance.
constexpr std::size_t surely = 16;

}  // namespace

void change_signs::take(bytes input) noexcept {
  for (const std::uint8_t byte : input) {
    ++each_[byte];
    if (byte == line_feed && last_[0] == carriage_return) {
      ++crlf_.count;
      crlf_.before.set(last_[1]);
    }
    if (last_[0] == line_feed) crlf_.behind.set(byte);
    if (byte < behind_.size()) behind_[byte].set(last_[0]);
    if (byte == packet_start[1] && last_[0] == (packet_start[0] & 0x7FU)) ++stripped_starts_;
    take_telnet(byte);
    take_utf8(byte);
    take_header_byte(byte);
    taken_.take(byte);
    last_ = {byte, last_[0]};
  }
}

void change_signs::take_telnet(std::uint8_t byte) noexcept {
  if (telnet_.is_option) {
    telnet_.is_option = false;
    ++(byte < 0x40 ? telnet_.negotiated : telnet_.single);  // the options of telnet are below
  } else if (telnet_.is_half) {
    telnet_.is_half = false;
    telnet_.is_option = byte >= 0xFB && byte <= 0xFE;
    if (byte == interpret) {
      ++telnet_.doubled;
    } else if (!telnet_.is_option) {
      ++telnet_.single;
    }
  } else {
    telnet_.is_half = byte == interpret;
  }
}

void change_signs::take_utf8(std::uint8_t byte) noexcept {
  const bool continues = (byte & 0xC0U) == 0x80U;
  if (utf8_.awaited > 0 && continues) {
    utf8_.sum = utf8_.sum << 6U | (byte & 0x3FU);
    if (--utf8_.awaited > 0) return;
    ++utf8_.sequences[utf8_.lead == 0xC2 || utf8_.lead == 0xC3 ? 0 : 1];
    utf8_.replaced += utf8_.sum == 0xFFFD ? 1U : 0U;
    return;
  }
  utf8_.malformed += utf8_.awaited > 0 ? 1U : 0U;
  utf8_.awaited = 0;
  if (byte < 0x80) return;
  utf8_.lead = byte;
  if (byte >= 0xC2 && byte <= 0xDF) {
    utf8_.awaited = 1;
    utf8_.sum = byte & 0x1FU;
  } else if (byte >= 0xE0 && byte <= 0xEF) {
    utf8_.awaited = 2;
    utf8_.sum = byte & 0x0FU;
  } else {
    ++utf8_.malformed;
  }
}

void change_signs::take_header_byte(std::uint8_t byte) noexcept {
  std::size_t& size = headers_.size;
  if (size < packet_start.size()) {
    size = byte == packet_start[size] ? size + 1 : byte == packet_start[0] ? 1 : 0;
    return;
  }
  headers_.bytes[size++] = byte;
  if (size < header_size) return;
  size = 0;
  take_header();
}

void change_signs::take_header() noexcept {
  ++headers_.count;
  for (const std::size_t at : {4U, 6U}) {
    const std::uint8_t byte = headers_.bytes[at];
    if (byte % 2 != 0) continue;  // as every word of an angle
    headers_.with_0a += byte == line_feed ? 1U : 0U;
    headers_.with_20 += byte == blank ? 1U : 0U;
    ++headers_.even;
  }
}

/// Whether angles contain what replaces this character more often than anything else that an angle cannot contain.
bool change_signs::is_replaced(unsigned control, std::uint64_t replaced) const noexcept {
  return count_of(control) == 0 && replaced >= 3 && 4 * replaced > headers_.even;
}

change_signs::control_set change_signs::missing() const noexcept {
  control_set absent;
  if (headers_.count < few) return absent;
  // Those of a head that stands, or of equal revolutions, are equal: each is counted once with the byte before it.
  std::size_t fewest = behind_[usual_controls[0]].count();
  for (const std::uint8_t each : usual_controls) fewest = std::min(fewest, behind_[each].count());
  for (const std::uint8_t each : taken_alone) absent.set(each, count_of(each) == 0);
  for (const auto& [one, other] : taken_together) {
    const bool is_pair = count_of(one) == 0 && count_of(other) == 0;
    absent.set(one, is_pair).set(other, is_pair);
  }
  control_set taken = taken_.found(absent);
  const bool is_flow = taken.test(xon) || taken.test(xoff);
  taken.set(xon, is_flow).set(xoff, is_flow);
  // Of those that short packets do not show, each must be absent surely.
  if ((absent & ~taken).count() * fewest >= surely) return absent;
  absent = taken;
  if (is_replaced(carriage_return, headers_.with_0a)) absent.set(carriage_return);
  if (is_replaced(tab, headers_.with_20)) absent.set(tab);
  return absent;
}

stream_change change_signs::recoding() const noexcept {
  const auto [of_latin1, others] = utf8_.sequences;
  if (of_latin1 + others < few || 16 * utf8_.malformed > of_latin1 + others)
    return stream_change::none;
  if (8 * (of_latin1 + others - utf8_.replaced) <= utf8_.replaced) return stream_change::utf8;
  std::size_t kinds = 0;  // a stuck line has few
  for (unsigned byte = 0x80; byte < 0xC0; ++byte) kinds += count_of(byte) > 0 ? 1U : 0U;
  if (kinds < few) return stream_change::none;
  return others == 0 ? stream_change::latin1 : stream_change::recoded;
}

stream_change change_signs::change() const noexcept {
  const auto& [doubled, single, negotiated, is_half, is_option] = telnet_;
  if (single == 0 && (negotiated >= 3 || (negotiated > 0 && doubled >= few)))
    return stream_change::telnet;
  if (const auto found = recoding(); found != stream_change::none) return found;
  const bool has_high =
      std::any_of(each_.begin() + 0x80, each_.end(), [](auto n) { return n > 0; });
  if (!has_high && stripped_starts_ >= few) return stream_change::seven_bits;
  // Equal samples may be such a word, too: but with few bytes beside it.
  const bool varies = std::min(crlf_.before.count(), crlf_.behind.count()) >= few / 2;
  if (varies && crlf_.count == count_of(line_feed)) return stream_change::crlf;
  const control_set absent = missing();
  if (absent.none()) return stream_change::none;
  if (absent == control_set().set(tab)) return stream_change::tabs;
  const bool is_flow = (absent & ~control_set().set(xon).set(xoff)).none();
  return is_flow ? stream_change::flow_control : stream_change::cooked_line;
}

}  // namespace g4lidar
