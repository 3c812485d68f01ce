// SPDX-License-Identifier: MIT
// The bytes of both directions as annotated lines of text: each packet, response and command, and
// the skipped bytes with the reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "io/text_sink.hpp"
#include "time_shift.hpp"

namespace g4_tool {

using namespace g4lidar;

/// The name of a command in texts for people: "start", "health?"; "no command" if the protocol has
/// none with that code. *Pure*, valid forever. (protocol: Commands)
[[nodiscard]] std::string_view word_for_command(std::uint8_t code) noexcept;

/// How a protocol log is written.
struct protocol_log_style {
  bool hex = false;         ///< All bytes of everything, 16 per line.
  bool errors = false;      ///< Only skipped bytes and suspect packets.
  bool has_times = true;    ///< Each line begins with a time; else with the offset of its bytes.
  std::uint64_t lines = 0;  ///< The maximum number of lines; 0: no limit.
  sample_format format = g4_format;  ///< Of the packets.
};

/// Parses bytes that were sent and received, and writes a line for each item:
///
///     12.000345 > start  A5 60
///     12.004101 < scan started
///     12.105220 < packet   0.31 to  12.69 deg, 40 samples, checksum ok
///     12.110004 ! skipped 3 bytes: noise  00 00 13
///
/// Each line has a time in seconds with six decimals (or the offset of the first byte), a symbol,
/// and a description. Symbols: `>` to the device, `<` from the device, `!` skipped or suspect, `-`
/// remarks. Lines with `>` and `!` end with their first 16 bytes. Texts of a device or a recording
/// are escaped: see printable(). Keeps the bytes that are not parsed yet: at most some packets, and
/// 64 KiB of skipped bytes. *Single thread*, allocates.
class protocol_log {
 public:
  /// `out` must outlive this. `times` converts the times.
  protocol_log(const protocol_log_style& style, const time_shift& times, text_sink& out);

  /// Adds bytes that were received at `time_ns`, in pieces of any size.
  void from_device(bytes data, std::int64_t time_ns);
  /// Adds bytes that were sent at `time_ns`: complete commands.
  void to_device(bytes data, std::int64_t time_ns);
  /// Adds another event: "opened /dev/ttyUSB0".
  void remark(std::string_view words, std::int64_t time_ns);
  /// No more bytes follow the received ones: the connection was lost, or the input has ended.
  void finish();
  /// Writes skipped bytes that were delayed because more of the same reason may follow.
  void settle();

  /// Whether the maximum number of lines has been written.
  [[nodiscard]] bool is_done() const noexcept { return style_.lines > 0 && lines_ >= style_.lines; }
  /// What the parser found so far.
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// The number of bytes that the device sent.
  [[nodiscard]] std::uint64_t bytes_from_device() const noexcept { return bytes_; }
  /// The number of commands to the device.
  [[nodiscard]] std::uint64_t commands() const noexcept { return commands_; }

 private:
  void take(const event& found);
  void take(packet_view packet);
  void take(response_view response);
  void take(time_packet_view packet);
  void take(empty_packet_view packet);
  void take(skipped gone);
  [[nodiscard]] std::string meaning_of(response_view response) const;
  void write_line(char mark, std::string_view words, bytes data, std::int64_t time_ns,
                  std::uint64_t place);

  protocol_log_style style_;
  time_shift times_;
  text_sink& out_;
  stream_parser parser_;
  stream_counter counts_;
  std::vector<std::uint8_t> pending_;  // received; the part behind taken_
  std::size_t taken_ = 0;              // is not in an event yet
  std::vector<std::uint8_t> skipped_;  // not written yet, all with the same reason
  skip_reason reason_ = skip_reason::noise;
  std::int64_t skipped_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::uint64_t place_ = 0;  // the offset of the next byte
  std::uint64_t bytes_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t lines_ = 0;
  std::uint8_t asked_ = 0;  // the code of the last command
};

}  // namespace g4_tool
