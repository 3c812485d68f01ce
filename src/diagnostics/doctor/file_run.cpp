// SPDX-License-Identifier: MIT
// The stages of a file: a recording, or raw bytes without times.
#include "diagnostics/stages.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include "diagnostics/link_monitor.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/source.hpp"
#include "link/identity_reader.hpp"

namespace g4lidar {
namespace {

constexpr const char* needs_device = "This stage needs a device; this is a file.";
/// Between two checks of the speed of the head.
constexpr std::uint64_t steady_samples = 1'000;

bool is_stop(bytes sent) noexcept {
  return sent.size() == 2 && (sent[1] == static_cast<std::uint8_t>(command::stop) ||
                              sent[1] == static_cast<std::uint8_t>(command::forced_stop));
}

class file_run {
 public:
  file_run(stage_log& log, const model& model)
      : log_(log), model_(model), splitter_(model.samples), stated_(model, true) {}

  /// `wrong`: why it is not read.
  void run(const std::string& path, const std::optional<error>& wrong) {
    port_.add("path", path);
    if (model_ != g4_model) port_.add("model", std::string(model_.word));
    const bool is_read = wrong                ? fail(*wrong)
                         : is_recording(path) ? read_recording(path)
                                              : read_bytes(path);
    splitter_.finish(to_);
    survey_.finish();
    if (!is_read || measured_.tally().arrivals.bytes() == 0) {
      port_.find(diagnosis::bad_file);
      log_.report(std::move(port_));
      return log_.skip_from(diagnostic_stage::permission, "Not reached.");
    }
    log_.report(std::move(port_));
    report();
  }

 private:
  bool read_recording(const std::string& path) {
    port_.add("format", "recording");
    auto opened = recording_reader::open(path, {.is_cancelled = log_.options().is_cancelled});
    if (!opened) return fail(opened.error());
    recording_reader& reader = *opened;
    const auto read = reader.for_each([this](const recorded_item& item) {
      take(item);
      return !is_cancelled();
    });
    if (!read && read.error() != problem::cancelled) return fail(read.error());
    const recording_damage& damage = reader.damage();
    if (damage.bytes_skipped > 0) port_.add("damaged_bytes", damage.bytes_skipped);
    if (damage.chunks_lost > 0) port_.add("lost_chunks", damage.chunks_lost);
    if (damage.is_cut_off) port_.remark = "The recording was cut off: it has no end.";
    if (const auto& device = reader.device()) {
      if (!device_.information && device->information.is_known()) {
        device_.information = device->information;
      }
      device_.frequency = device->frequency;
      if (device->sample_rate) device_.sample_rate_hz = to_hz(*device->sample_rate);
      if (device->recognised) {
        recognition seen_as = *device->recognised;
        seen_as.has_shown_samples = true;  // nothing more is awaited
        if (seen_as.model == nullptr || *seen_as.model != model_) seen_as.by = known_by::user;
        seen_as.model = &model_;
        if (!port_.remark.empty()) port_.remark += " ";
        port_.remark += contradictions_of(seen_as);
      }
    }
    seconds_ = static_cast<double>(detail::saturating_sub(last_ns_, reader.first_ns())) / 1e9;
    return true;
  }

  bool read_bytes(const std::string& path) {
    port_.add("format", "bytes");
    const auto opened = open_raw_bytes(path, {}, {}, {}, &model_);
    if (!opened) return fail(opened.error());
    const auto port = (*opened)->connect();
    if (!port) return fail(port.error());
    std::array<std::uint8_t, 4096> buffer{};
    while (!is_cancelled()) {
      const auto got = (*port)->read(buffer, never_ns);
      if (!got) return got.error() == problem::end_of_input || fail(got.error());
      take(bytes(buffer).first(got->count), 0);
    }
    return true;
  }

  bool fail(const error& why) {
    port_.remark = cause_of(why);
    return false;
  }
  [[nodiscard]] bool is_cancelled() const {
    return log_.options().is_cancelled && log_.options().is_cancelled();
  }

  void take(const recorded_item& item) {
    if (item.what != recorded_item::kind::odometry) last_ns_ = item.time_ns;
    switch (item.what) {
      case recorded_item::kind::from_device:
        return take(item.data, item.time_ns);
      case recorded_item::kind::to_device:
        replies_.sent(item.data);
        survey_.sent(item.data);
        if (is_stop(item.data)) await_speed();
        return;
      case recorded_item::kind::other:
        if (item.other.zero) device_.zero = item.other.zero;
        if (item.other.what == recorded_event::kind::gap) measured_.part();
        if (item.other.what == recorded_event::kind::closed) await_speed();
        return;
      case recorded_item::kind::odometry:
        return;
    }
  }

  void take(bytes data, std::int64_t arrival_ns) {
    // Before a scan runs, silence is not a stall; only recordings show how long it lasted.
    const bool follows = is_judging_ && arrival_ns > 0 && arrival_ns_ > 0;
    measured_.take(timed_read{data.size(), arrival_ns,
                              follows ? detail::saturating_sub(arrival_ns, arrival_ns_) : 0});
    arrival_ns_ = arrival_ns;
    survey_.received(data);
    splitter_.take(data, arrival_ns, to_);
  }

  void take(const observed_event& observed) {
    stated_.take(observed.what);
    if (const auto* response = std::get_if<response_view>(&observed.what)) {
      device_.take(*response);
      if (const auto zero = replies_.take(*response, model_).zero) device_.zero = zero;
      if (response->kind() == response_kind::scan_started) await_speed();
    }
    if (std::get_if<response_view>(&observed.what) == nullptr) replies_.pass();
    measured_.take(observed);
    if (is_judging_ || measured_.tally().samples < looked_ + steady_samples) return;
    looked_ = measured_.tally().samples;
    if (!measured_.is_steady()) return;
    measured_.resume();
    is_judging_ = true;
  }

  /// A scan begins: its packets are evaluated when the head has reached its speed.
  void await_speed() {
    measured_.suspend();
    is_judging_ = false;
    looked_ = measured_.tally().samples;
  }

  void report() {
    log_.skip(diagnostic_stage::permission, needs_device);
    log_.skip(diagnostic_stage::holder, needs_device);
    if (!report_contents()) return;
    report_answers();
    report_motor();
    if (measured_.tally().counts.packets == 0)
      return log_.skip_from(diagnostic_stage::stream, "There are no packets.");
    stage_report stream{.stage = diagnostic_stage::stream};
    if (splitter_.boots() > 0) stream.add("boots", splitter_.boots());
    judge_stream(stream, measured_, seconds_);
    log_.report(std::move(stream));
    report_rate(log_, measured_, device_, model_);
    report_loss(log_, measured_, model_, &survey_, seconds_);
    report_returns(log_, measured_, device_, model_, log_.options().directions);
    log_.skip(diagnostic_stage::usb_latency,
              "The reader of a file or a recording groups bytes itself.");
  }

  /// The stage baud_rate. Returns whether the packets may be those of the model.
  bool report_contents() {
    stage_report baud{.stage = diagnostic_stage::baud_rate};
    const stream_counts& counts = measured_.tally().counts;
    baud.add("bytes", measured_.tally().arrivals.bytes());
    baud.add("packets", counts.packets);
    baud.add("responses", counts.responses);
    const bool has_packets = counts.packets > few_packets;
    if (!has_packets && find_other_source(baud, survey_)) {
      log_.report(std::move(baud));
      log_.skip_from(diagnostic_stage::answers, "There are no packets of this family of lidars.");
      return false;
    }
    if (find_other_layout(baud, survey_.layout(), model_)) {
      log_.report(std::move(baud));
      log_.skip_from(diagnostic_stage::answers,
                     "The packets are not those of " + one_of(model_) + ".");
      return false;
    }
    const auto found = diagnosis_of(counts, measured_.tally().arrivals.bytes());
    const bool is_changed = survey_.change() != stream_change::none;
    if (found) baud.find(is_changed ? diagnosis::changed_bytes : *found);
    if (found == diagnosis::unknown_bytes) baud.remark = arrived(survey_);
    if (survey_.maker() != nullptr || (found && is_changed)) baud.remark = survey_.finding();
    log_.report(std::move(baud));
    return true;
  }

  /// What answers and the file state about the lidar.
  void report_answers() {
    const bool has_packet = measured_.tally().counts.packets > 0;
    if (has_packet && has_request(model_, request_kind::zero_angle) && !device_.zero) {
      stage_report answers{.stage = diagnostic_stage::answers};
      answers.find(diagnosis::no_zero_angle);
      answers.remark = "The answer to command 93 is not in this file.";
      log_.report(std::move(answers));
    } else {
      log_.skip(diagnostic_stage::answers, needs_device);
    }
    if (!device_.information) device_.information = stated_.who();
    if (!device_.condition) device_.condition = stated_.condition();
    report_identity(log_, device_.information, model_, 0);
    report_health(log_, device_.condition);
  }

  void report_motor() {
    stage_report motor{.stage = diagnostic_stage::motor};
    // Two comparisons of the speed need three times its samples, and the motor some seconds to spin up; a head that stands
    // still shows it sooner.
    constexpr std::uint64_t spin_up_s = 3;
    const std::uint64_t least = std::max(3 * steady_samples, spin_up_s * first_rate_hz(model_));
    const bool is_short =
        !measured_.was_steady() && !measured_.stands() && measured_.tally().samples < least;
    if (is_short || measured_.tally().counts.packets <= few_packets) {
      motor.outcome = stage_verdict::skipped;
      motor.remark = "There are too few packets.";
    } else {
      judge_motor(motor, measured_);
      if (motor.diagnoses.empty())
        motor.remark = "The angles in the packets show a constant speed.";
    }
    log_.report(std::move(motor));
  }

  stage_log& log_;
  const model& model_;
  stage_report port_{};
  event_splitter splitter_;
  stream_survey survey_;
  observer to_{.event = [this](const observed_event& observed) { take(observed); }};
  stream_statistics measured_{model_};
  device_snapshot device_;
  identity_reader stated_;  // in CT bytes, too
  reply_watch replies_;
  std::uint64_t looked_ = 0;  // samples at the last check of the speed
  bool is_judging_ = false;
  std::int64_t arrival_ns_ = 0;
  std::int64_t last_ns_ = 0;
  double seconds_ = 0.0;
};

}  // namespace

void examine_file(const std::string& source, stage_log& log) {
  const diagnostic_options& options = log.options();
  const std::string path = path_of_source(source);
  result<const model*> which = options.model;
  // Bytes that cannot be read as the model that is named are examined all the same.
  if (options.model == nullptr || is_recording(path)) {
    which = model_of_source({.device = source,
                             .model = options.model,
                             .insist_on_model = options.insist_on_model,
                             .is_cancelled = options.is_cancelled});
  }
  const model* const used = which.value_or(nullptr);
  file_run(log, used != nullptr ? *used : g4_model)
      .run(path, which ? std::nullopt : std::optional(which.error()));
}

}  // namespace g4lidar
