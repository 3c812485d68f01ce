// SPDX-License-Identifier: MIT
// Records the connection to the lidar while a page wants it, into the directory of --allow-record.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/transport/transport.hpp"
#include "page_protocol.hpp"

namespace g4_tool {

/// One recording at a time, with a name that this class chooses, in files that did not exist before. It begins in the
/// middle of a scan: the connection is not interrupted. *Single thread*, that of the reader, but for status().
class page_recorder {
 public:
  /// The largest number of recordings in the directory.
  static constexpr std::size_t most_files = 1000;

  /// The lidar among those that are recorded at the same time.
  struct recorded_lidar {
    std::string name{};  ///< A part of the names of files; empty for the only one.
    std::size_t count = 1;
  };

  /// `directory`: empty if nobody may record. `most_bytes`: of all recordings in it; each lidar gets an equal part of
  /// what is free. Throws a failure if it cannot be written to.
  page_recorder(std::string directory, std::uint64_t most_bytes,
                const recorded_lidar& lidar = only_lidar());
  page_recorder(const page_recorder&) = delete;
  page_recorder& operator=(const page_recorder&) = delete;
  ~page_recorder();

  [[nodiscard]] bool is_allowed() const noexcept { return !directory_.empty(); }
  /// For lidar_options::wrap. This outlives the result.
  [[nodiscard]] std::unique_ptr<g4lidar::connector> observe(
      std::unique_ptr<g4lidar::connector> source);
  /// The lidar was opened, and does not scan yet.
  void opened(g4lidar::lidar& device);

  /// Begins a recording, or ends it. Returns the error; empty if there is none.
  [[nodiscard]] std::string set(bool is_on);
  /// Ends the recording, if there is one.
  void end(const std::string& why = {}, bool discards = false);
  /// Ends it, and removes the file.
  void discard() { end({}, true); }
  void add(const g4lidar::scan& found);
  void add(const g4lidar::stamped_odometry& odometry);

  /// Nothing if nobody may record. *Any thread.*
  [[nodiscard]] std::optional<page_recording> status() const;

 private:
  [[nodiscard]] static recorded_lidar only_lidar() { return {}; }

  [[nodiscard]] std::string begin();
  /// What is wrong with the directory, or how much may be written.
  [[nodiscard]] std::string measure(std::uint64_t& free_bytes) const;
  /// After each read: ends it if something went wrong, or it is too long.
  void check();

  const std::string directory_;
  const std::uint64_t most_bytes_;
  const recorded_lidar lidar_;
  std::uint64_t free_bytes_ = 0;  // of this recording
  g4lidar::recorded_device known_;
  const g4lidar::model* model_ = nullptr;  // of the last scan
  g4lidar::recording_switch switch_;
  std::optional<g4lidar::recording_writer> writer_;
  std::int64_t begin_ns_ = 0;
  mutable std::mutex mutex_;  // protects the next member
  page_recording shown_;
};

}  // namespace g4_tool
