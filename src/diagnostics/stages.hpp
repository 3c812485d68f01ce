// SPDX-License-Identifier: MIT
// The reports of a diagnostic run so far, and the stages without a class of their own.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/filter.hpp"
#include "reply_statistics.hpp"
#include "stream_statistics.hpp"
#include "survey/stream_survey.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {

/// *Single thread.*
class stage_log {
 public:
  explicit stage_log(const diagnostic_options& options) : options_(options) {}

  /// The bytes come on this way, as far as it is known from the name of their source.
  void come_by(byte_path by) noexcept { by_ = by; }
  void come_from(std::string_view name) noexcept {
    if (is_bridge(name)) by_ = byte_path::network;
  }
  [[nodiscard]] byte_path by() const noexcept { return by_; }
  void report(stage_report done) {
    done.by = by_;
    if (options_.on_stage) options_.on_stage(done);
    stages_.push_back(std::move(done));
  }
  void skip(diagnostic_stage stage, std::string why) {
    report({.stage = stage, .outcome = stage_verdict::skipped, .remark = std::move(why)});
  }
  /// Skips all stages from `stage` on.
  void skip_from(diagnostic_stage stage, const std::string& why) {
    for (auto at = static_cast<std::size_t>(stage); at < diagnostic_stage_count; ++at) {
      skip(static_cast<diagnostic_stage>(at), why);
    }
  }
  void begin(diagnostic_activity what) {
    if (options_.on_activity) options_.on_activity(what);
  }
  [[nodiscard]] const diagnostic_options& options() const noexcept { return options_; }
  [[nodiscard]] std::vector<stage_report>& stages() noexcept { return stages_; }

 private:
  const diagnostic_options& options_;
  byte_path by_ = byte_path::line;
  std::vector<stage_report> stages_;
};

/// The rate at which a run begins: that of the user, or of his model; else `otherwise`.
[[nodiscard]] constexpr std::uint32_t first_baud(const diagnostic_options& options,
                                                 std::uint32_t otherwise) noexcept {
  if (options.baud != 0) return options.baud;
  return options.model != nullptr ? options.model->bauds[0] : otherwise;
}
/// The stage to which a diagnosis of a connection or of a running scan belongs.
[[nodiscard]] diagnostic_stage stage_of(diagnosis what) noexcept;
/// The message of an error without its advice, which the diagnosis has.
[[nodiscard]] std::string cause_of(const error& why);
/// Reports all stages of a recording or of raw bytes; those that need a device as skipped.
void examine_file(const std::string& source, stage_log& log);

// The stages that devices and files share.

/// The program was suspended for as long as a stall: what depends on time is not judged.
[[nodiscard]] bool is_host_busy(const stream_statistics& measured) noexcept;

/// Whether most bytes are those of packets whose headers can be seen: at another baud rate there are none. *Pure.*
[[nodiscard]] bool is_mostly_damaged(const stream_statistics& measured) noexcept;

/// Whether a lidar that was named is refused for its number, as lidar::open() refuses it. `baud` 0: not known.
[[nodiscard]] bool refuses_number(const diagnostic_options& options, const model& stated,
                                  std::uint8_t number, std::uint32_t baud);
/// identity; false for another model than `wanted`, surely. `baud`, `sample_bytes` 0: not known.
bool report_identity(stage_log& log, const std::optional<device_information>& known,
                     const model& wanted, std::uint32_t baud, std::size_t sample_bytes = 0);
/// health; false if the device reports an error.
bool report_health(stage_log& log, const std::optional<health>& known);
/// Up to this number of packets the motor cannot be evaluated.
inline constexpr std::uint64_t few_packets = 30;
/// The diagnoses of the stage motor, if it has reached its speed or had the time to.
void judge_motor(stage_report& motor, const stream_statistics& measured);
/// rate, by the rates of `wanted`.
void report_rate(stage_log& log, const stream_statistics& measured, const device_snapshot& known,
                 const model& wanted);
/// `seen`: the same bytes; null: they were not examined. `seconds`: how long they took; 0: not known.
void report_loss(stage_log& log, const stream_statistics& measured, const model& wanted,
                 const stream_survey* seen = nullptr, double seconds = 0.0);
/// returns: whether something came back, and the sectors from which nothing did, but for directions that the user
/// leaves out.
void report_returns(stage_log& log, const stream_statistics& measured, const device_snapshot& known,
                    const model& wanted, const point_filter& directions);
/// `baud` 0: bytes take no time. `name` is that of the transport: not all have a USB bridge.
void report_latency(stage_log& log, const stream_statistics& measured, std::uint32_t baud,
                    std::string_view name);
/// "a G4", "an X4".
[[nodiscard]] std::string one_of(const model& model);
/// "x2, x2l and x3": the words of these models.
[[nodiscard]] std::string words_of(std::span<const model* const> all);
/// The number with so many digits in this base.
[[nodiscard]] std::string digits_of(unsigned number, unsigned base, std::size_t count);
/// "10c4:ea60": vendor and product.
[[nodiscard]] std::string usb_id_of(const port_info& port);
/// "25 bytes like an answer of another length (A5 5A 15 00 00 00) arrived."; empty if there were none.
[[nodiscard]] std::string arrived(const stream_survey& heard);
/// What was examined is no stream of a lidar: of another maker, text, an echo, or changed on the way. Returns whether it
/// is not.
bool find_other_source(stage_report& report, const stream_survey& seen);
/// Whether the samples have a size that no lidar like `wanted` sends; then adds this to `report`.
bool find_other_layout(stage_report& report, const layout_recogniser& seen, const model& wanted);
/// Whether this path leads to a pseudo-terminal.
[[nodiscard]] bool is_pty(const std::string& path);
/// Numbers and diagnoses of the stage stream.
void judge_stream(stage_report& stream, const stream_statistics& measured, double seconds);

}  // namespace g4lidar
