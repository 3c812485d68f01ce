// SPDX-License-Identifier: MIT
// A line that is listened to byte by byte, and questions asked on it: what the doctor measures with.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "g4lidar/command.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/stream_parser.hpp"
#include "g4lidar/transport.hpp"

namespace g4_dump {

/// What came: an event of the parser, its bytes, and when the last of them came.
struct heard {
  const g4lidar::event& what;
  g4lidar::bytes raw;
  std::int64_t arrival_ns;
};

/// Some bytes that came together.
struct batch {
  std::size_t count;
  std::int64_t arrival_ns;
  std::int64_t silence_ns;  ///< Before it, as far as somebody was listening.
};

/// What became of a question.
struct exchange {
  g4lidar::command asked{};
  std::int64_t asked_ns = 0;
  std::int64_t answered_ns = -1;        ///< -1: not answered.
  std::vector<std::uint8_t> content{};  ///< Of the answer.
  unsigned copies = 0;                  ///< Of the same answer, after the first.
  unsigned wrong = 0;                   ///< Answers that are none to this question.
  unsigned packets = 0;
  std::size_t skipped = 0;  ///< Bytes in no frame.
  bool booted = false;      ///< The text of a boot came.

  [[nodiscard]] bool is_answered() const noexcept { return answered_ns >= 0; }
  [[nodiscard]] std::int64_t latency_ns() const noexcept { return answered_ns - asked_ns; }
  [[nodiscard]] bool heard_nothing() const noexcept {
    return !is_answered() && wrong == 0 && packets == 0 && skipped == 0;
  }
};

/// Where what comes goes. Either may be empty.
struct listener {
  std::function<void(const heard&)> event{};
  std::function<void(const batch&)> arrival{};
};

/// *Single thread.* After a loss (error()) nothing comes any more, and everything returns at once.
class ear {
 public:
  ear(std::unique_ptr<g4lidar::transport> line, std::function<bool()> is_interrupted)
      : line_(std::move(line)), is_interrupted_(std::move(is_interrupted)) {}

  /// Listens until `until_ns`, which the listener may move, or the end.
  void listen(const std::int64_t& until_ns, const listener& to);
  /// Listens until nothing has come for `quiet_ns`, at most until `until_ns`; whether it is quiet.
  bool listen_for_quiet(std::int64_t quiet_ns, std::int64_t until_ns, const listener& to = {});

  /// A frame that does not go on for so long is taken to have ended. A line that is held up may take
  /// long in its middle.
  void give_frames(std::int64_t pause_ns) noexcept { frame_pause_ns_ = pause_ns; }

  void send(g4lidar::command code);
  /// Asks, and waits for the answer for at most `patience_ns`, then for a second one.
  [[nodiscard]] exchange ask(g4lidar::command code, std::int64_t patience_ns);

  [[nodiscard]] std::int64_t now_ns() const noexcept { return line_ ? line_->now_ns() : ended_ns_; }
  /// What ended the line.
  [[nodiscard]] const std::optional<g4lidar::error>& error() const noexcept { return error_; }
  [[nodiscard]] bool is_interrupted() const noexcept { return interrupted_; }
  /// From now on there are no interrupts: what is left to be done is to stop the motor.
  void ignore_interrupts() noexcept {
    is_interrupted_ = nullptr;
    interrupted_ = false;
  }
  [[nodiscard]] bool is_over() const noexcept { return interrupted_ || error_ || !line_; }
  /// Bytes in frames, packets, boot texts: since the begin.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// When the last of them came.
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return heard_ns_; }
  [[nodiscard]] std::uint64_t boots() const noexcept { return boots_; }
  [[nodiscard]] g4lidar::transport& line() noexcept { return *line_; }
  /// Another line in the place of this one; `make` is called when the old one is closed.
  void replace(const std::function<std::unique_ptr<g4lidar::transport>()>& make);

 private:
  void take(std::size_t count, std::int64_t arrival_ns, const listener& to);
  void give(const g4lidar::event& found, const listener& to);
  void finish(const listener& to);
  void look_for_text(g4lidar::bytes raw);

  std::unique_ptr<g4lidar::transport> line_;
  std::function<bool()> is_interrupted_;
  std::optional<g4lidar::error> error_;
  bool interrupted_ = false;
  std::int64_t ended_ns_ = 0;
  g4lidar::stream_parser parser_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::vector<std::uint8_t> raw_;  // taken in, and in no event yet
  std::size_t raw_begin_ = 0;
  std::int64_t heard_ns_ = 0;
  std::int64_t frame_pause_ns_ = 60'000'000;
  std::int64_t silence_ns_ = 0;
  std::uint64_t bytes_ = 0;
  std::uint64_t boots_ = 0;
  std::size_t letters_ = 0;  // in a row
  bool in_text_ = false;
};

/// The kind of response that answers a command.
[[nodiscard]] std::optional<g4lidar::response_kind> answer_kind(g4lidar::command code) noexcept;

}  // namespace g4_dump
