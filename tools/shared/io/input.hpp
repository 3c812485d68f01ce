// SPDX-License-Identifier: MIT
// Bytes from a file, a pipe or standard input; the contents of a recording; the counts of raw bytes as
// text or JSON; the error for an input without packets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "source_word.hpp"

namespace g4_tool {

/// The receiver of the bytes.
struct byte_sink {
  std::function<void(std::span<const std::uint8_t>)> take;
  std::function<bool()> is_done{};  ///< If set: called after each piece.
};

/// The failure of a file that could not be opened, by its errno: why, and what to do.
[[nodiscard]] failure not_opened(const std::string& title, int error,
                                 const std::string& what_to_give);

/// An input that is read once, from its beginning to its end. Owns its descriptor.
class input {
 public:
  /// Opens a file, or standard input for `-`. `what_to_give` is the advice in failures: "Give a file
  /// with ...".
  input(const std::string& name, const std::string& what_to_give);
  input(const input&) = delete;
  input& operator=(const input&) = delete;
  ~input();

  /// What sends the bytes of a pipe: reads ahead until it is known, as g4lidar::stream_head states, and
  /// at most until -d or --idle ends.
  [[nodiscard]] g4lidar::recognised_model recognise(const common_options& options);

  /// The first line of text that is not empty, without its end: reads ahead, at most 64 KiB, and of a
  /// pipe at most until -d or --idle ends.
  [[nodiscard]] std::string first_line(const common_options& options);

  /// Waits for bytes and reads them. Returns their number: 0 at the end or after a signal.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> into);

  /// Reads until `sink` is done, the end of the input, a signal, -d or --idle of a pipe, or the reader of
  /// `out` closes it. `out` is flushed before each wait, and after the first piece of a file.
  void pump(output& out, const byte_sink& sink, const common_options& options);

  /// Whether it is a file on disk, which has an end.
  [[nodiscard]] bool is_file() const noexcept { return is_file_; }

  /// Its name in messages.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  /// Waits for more bytes of a pipe; false if there is no reason to read on.
  [[nodiscard]] bool wait(output& out, const time_limits& limits) const;

  int fd_ = 0;
  std::string title_;
  bool is_file_ = false;
  std::uint64_t size_ = 0;
  std::vector<std::uint8_t> ahead_;  // read by recognise() or first_line()
};

/// Opens a recording; by default a signal cancels reading. Throws interrupted if opening was cancelled,
/// or a failure.
[[nodiscard]] g4lidar::recording_reader open_recording(const std::string& path,
                                                       g4lidar::reading_options range = {});

/// Calls `take` with each item in `range` until it returns false, a signal comes, or the recording
/// ends; shows the progress. Returns the reader, for its state at the end. Throws a failure.
g4lidar::recording_reader read_items(
    const std::string& path, const g4lidar::reading_options& range,
    const std::function<bool(const g4lidar::recorded_item&)>& take);

/// The damage of a recording as a text line; empty if there is none.
[[nodiscard]] std::string describe(const g4lidar::recording_damage& damage);

/// Two lines for people.
[[nodiscard]] std::string stats_in_words(const g4lidar::stream_counts& counts, std::uint64_t bytes);

/// An object with the counts; "skipped" is an object of bytes by reason.
[[nodiscard]] nlohmann::ordered_json counts_as_json(const g4lidar::stream_counts& counts,
                                                    std::uint64_t bytes);

/// The beginning of the file at `path`; nothing of what is no regular file, or cannot be read.
[[nodiscard]] std::vector<std::uint8_t> beginning_of(const std::string& path);

/// The failure of text or of the frames of another maker, of which `found` are sentences.
[[nodiscard]] failure not_packets(std::string_view found);

/// The failure of a recording, or of a part that begins after its end, without a packet.
[[nodiscard]] failure no_packet_in(const std::string& source, bool is_from_a_time);

/// The failure of an input that has nothing to write: no whole revolution if `is_of_scans`, else no point.
[[nodiscard]] failure nothing_to_write(const std::string& title, bool is_of_scans);

/// The failure of an input whose `bytes` bytes, which begin with `beginning`, contain no packet: why, and what to do.
[[nodiscard]] failure without_packets(const g4lidar::stream_counts& counts, std::uint64_t bytes,
                                      std::span<const std::uint8_t> beginning,
                                      const std::string& title);

/// A warning that names what else than packets an input with this beginning contains, or else that most of its bytes
/// belong to no packet; empty if there is no reason. Nothing without packets: see without_packets().
[[nodiscard]] std::string warning_about(const g4lidar::stream_counts& counts, std::uint64_t bytes,
                                        std::span<const std::uint8_t> beginning);

}  // namespace g4_tool
