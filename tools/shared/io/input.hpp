// SPDX-License-Identifier: MIT
// Bytes from a file, a pipe or standard input, as they come; the contents of a recording; the counts
// of raw bytes as text or JSON, and what is wrong with an input that holds no packet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "cli/common_options.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/recording/reader.hpp"
#include "interrupt.hpp"
#include "output.hpp"

namespace g4_tool {

/// What becomes of the bytes.
struct byte_sink {
  std::function<void(std::span<const std::uint8_t>)> take;
  std::function<bool()> is_done{};  ///< Asked after each piece, where it is set.
  bool with_bar = true;             ///< Whether to show how far a file has been read.
};

/// Something that is read from its beginning to its end. Closes itself.
class input {
 public:
  /// The file of that name, `-` for standard input. `what_to_give` ends the sentence of a failure:
  /// "Give a file with ...".
  input(const std::string& name, const std::string& what_to_give);
  input(const input&) = delete;
  input& operator=(const input&) = delete;
  ~input();

  /// Reads what is there, waiting until something is; how many bytes, 0 at the end or after a signal.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> into);

  /// Reads until `sink` is done, the end of the input, a signal, -d or --idle of a pipe, or nobody
  /// reads `out` any more. Who reads `out` has all there is before more is waited for, and the first of a file at once.
  void pump(output& out, const byte_sink& sink, const common_options& options);

  /// Where it is a file on disk: which one.
  [[nodiscard]] const std::optional<file_id>& id() const noexcept { return id_; }

  /// As it stands in sentences.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  /// Waits for more of a pipe; false where the end has come.
  [[nodiscard]] bool wait(output& out, const time_limits& limits) const;

  int fd_ = 0;
  std::string title_;
  std::optional<file_id> id_;
  std::uint64_t size_ = 0;
};

/// A reader that a signal ends with cancelled, if `range` names no other reason. Throws interrupted
/// if it was ended while it opened, or a failure.
[[nodiscard]] g4lidar::recording_reader open_recording(const std::string& path,
                                                       g4lidar::reading_options range = {});

/// Calls `take` with each item in `range` until it returns false, a signal comes, or the recording
/// ends; with a progress bar. Returns the reader, for what it knows at the end. Throws a failure.
g4lidar::recording_reader read_items(
    const std::string& path, const g4lidar::reading_options& range,
    const std::function<bool(const g4lidar::recorded_item&)>& take);

/// What is missing from a recording, as a text line; empty where nothing is.
[[nodiscard]] std::string describe(const g4lidar::recording_damage& damage);

/// Two lines for people.
[[nodiscard]] std::string stats_in_words(const g4lidar::stream_counts& counts, std::uint64_t bytes);

/// An object with the keys bytes, packets, responses, points, suspect and skipped, the latter an
/// object of bytes by reason.
[[nodiscard]] nlohmann::ordered_json counts_as_json(const g4lidar::stream_counts& counts,
                                                    std::uint64_t bytes);

/// Whether bytes look like text, which no recording is: only the first ones are looked at.
[[nodiscard]] bool looks_like_text(std::span<const std::uint8_t> bytes) noexcept;

/// Why there is no packet in `bytes` bytes of `title`, and what to do: whole sentences.
[[nodiscard]] std::string why_no_packet(const g4lidar::stream_counts& counts, std::uint64_t bytes,
                                        bool has_text, const std::string& title);

/// A warning about an input most of which is no packet; empty if there is nothing to warn of.
[[nodiscard]] std::string warning_about(const g4lidar::stream_counts& counts, std::uint64_t bytes);

}  // namespace g4_tool
