// SPDX-License-Identifier: MIT
// The doctor's way through the stages of an opened line, with the line's own clock. It sends
// questions, a start and stops: no setting is changed, and the motor stands at the end.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "doctor_answers.hpp"
#include "doctor_ear.hpp"
#include "doctor_stream.hpp"
#include "doctor_words.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/transport.hpp"

namespace g4_dump {

struct exam_options {
  std::int64_t listen_ns = 5'000'000'000;  ///< To the running scan.
  /// Asked often; true ends the examination.
  std::function<bool()> is_interrupted{};
  /// The same line at another rate, for a device that makes no sense; nothing where there are none.
  /// The line before is closed by then.
  std::function<std::unique_ptr<g4lidar::transport>(std::uint32_t)> at_rate{};
};

/// One examination. *Single thread.*
class examination {
 public:
  using sink = std::function<void(const stage_report&)>;

  /// `tell` gets each stage from baud_rate on as it is done, those that are skipped too.
  examination(std::unique_ptr<g4lidar::transport> line, exam_options options, sink tell);

  void run();
  /// As told.
  [[nodiscard]] const std::vector<stage_report>& stages() const noexcept { return stages_; }

 private:
  /// What has become of a scan.
  enum class scan_state : unsigned char {
    runs,
    silent,  ///< Nothing comes any more.
    over,    ///< So is everything.
  };
  /// What has become of a device whose scan fell silent.
  enum class fate : unsigned char { resumed, booted, answers, dead, over };

  /// baud_rate; whether there is anybody to go on with.
  bool meet();
  /// Answer, identity, health.
  bool interview();
  bool tell_identity();
  bool tell_health();
  /// motor; whether the scan runs.
  bool start_motor();
  void listen_to_scan();
  void tell_stream();
  void tell_rate();
  void tell_loss();
  void tell_latency();

  /// Listens to what comes unasked, and stops a scan. False where it goes on, or makes no sense.
  bool make_quiet();
  bool first_contact();
  void ask_the_rest(exchange last, std::int64_t begin_ns);
  void look_for_the_rate(stage_report& baud);
  [[nodiscard]] bool scans_when_told();
  /// Starts the scan and waits until the head is at its speed, or will not come to it.
  [[nodiscard]] scan_state warm_up(stream_watch& watch, std::int64_t longest_ns);
  [[nodiscard]] scan_state listen_once(stream_watch& watch);
  [[nodiscard]] fate fate_of_silent();
  /// The scan fell silent while it was listened to; whether it goes on.
  bool revive(std::int64_t& until_ns);
  bool restart_scan(std::int64_t& until_ns);
  void start_scan();
  bool stop();

  void tell(stage_report report);
  void skip(stage where, std::string why);
  void skip_from(stage where, const std::string& why);
  /// Adds what ended the line, if anything has.
  bool note_loss(stage_report& report);

  exam_options options_;
  sink tell_;
  ear ear_;
  std::vector<stage_report> stages_;
  question_book book_;
  device_portrait portrait_;
  stream_watch watch_;
  stage_report answer_{.where = stage::answer};
  stage_report stream_{.where = stage::stream};
  bool is_deaf_ = false;  // it scans, whatever it is told
  bool is_steady_ = false;
  bool feeds_ = false;  // the protection
  std::uint32_t baud_ = 0;
  std::uint64_t packets_ = 0;  // before it was started
  std::uint64_t garbage_ = 0;  // bytes in no frame, before it was asked
  std::int64_t started_ns_ = 0;
  std::uint64_t boots_then_ = 0;
  bool introduced_itself_ = false;  // since the start, without having been asked
  std::int64_t fed_ns_ = 0;
  std::int64_t listened_ns_ = 0;
  unsigned restarts_ = 0;
};

}  // namespace g4_dump
