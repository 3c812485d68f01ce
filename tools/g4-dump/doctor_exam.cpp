// SPDX-License-Identifier: MIT
// The stages up to the health: whoever is there is listened to, silenced, and asked.
#include "doctor_exam.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/response.hpp"

namespace g4_dump {
namespace {

using namespace g4lidar;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t unasked_ns = 300 * ms;
constexpr std::int64_t quiet_ns = 70 * ms;
constexpr int times_to_stop = 3;
/// The first answer is waited for so long, each time it is asked for: a device may be booting, and
/// an answer may be late.
constexpr std::array<std::int64_t, 3> first_patience_ns{800 * ms, 800 * ms, 3'000 * ms};
/// Where bytes came that made no sense, so often more: it may have been noise.
constexpr std::size_t more_times = 5;
constexpr std::int64_t more_patience_ns = 300 * ms;
constexpr std::array<std::uint32_t, 5> other_rates{115200, 512000, 128000, 153600, 256000};

std::string text_of(std::string_view name) { return std::string(name); }

}  // namespace

examination::examination(std::unique_ptr<transport> line, exam_options options, sink tell)
    : options_(std::move(options)),
      tell_(std::move(tell)),
      ear_(std::move(line), options_.is_interrupted),
      baud_(ear_.line().baud()) {}

void examination::run() {
  if (!meet() || !interview() || !start_motor()) {
    ear_.ignore_interrupts();
    stop();
    const auto last = stages_.empty() ? stage::holder : stages_.back().where;
    return skip_from(static_cast<stage>(static_cast<unsigned char>(last) + 1), "Not reached.");
  }
  listen_to_scan();
  ear_.ignore_interrupts();
  const bool stopped = ear_.is_over() || stop();
  if (!stopped && !is_deaf_ && !watch_.has_become_garbage()) stream_.find(diagnosis::deaf);
  tell_stream();
  tell_rate();
  tell_loss();
  tell_latency();
}

void examination::tell(stage_report report) {
  if (tell_) tell_(report);
  stages_.push_back(std::move(report));
}

void examination::skip(stage where, std::string why) {
  tell({.where = where, .how = verdict::skipped, .remark = std::move(why)});
}

void examination::skip_from(stage where, const std::string& why) {
  for (auto at = static_cast<unsigned char>(where); at < stage_count; ++at) {
    skip(static_cast<stage>(at), why);
  }
}

bool examination::note_loss(stage_report& report) {
  const std::optional<g4lidar::error>& why = ear_.error();
  if (!why) return false;
  switch (why->what()) {
    case problem::gone:
    case problem::end_of_input:
      report.find(diagnosis::unplugged);
      break;
    case problem::interference:
      report.find(diagnosis::interference);
      break;
    default:
      report.find(diagnosis::system);
      break;
  }
  report.remark = why->message();
  return true;
}

bool examination::meet() {
  stage_report baud{.where = stage::baud_rate};
  if (baud_ != 0) baud.add("baud", baud_);
  const bool is_met = (make_quiet() && first_contact()) || packets_ > 0;
  bool goes_on = is_met;
  if (!is_met && !ear_.is_over()) {
    if (garbage_ == 0 && scans_when_told()) {
      answer_.find(diagnosis::answers_missing);
      goes_on = true;
    } else {
      look_for_the_rate(baud);
    }
  }
  note_loss(baud);
  const bool is_silent = !goes_on && baud.found.empty() && !ear_.is_interrupted();
  if (is_silent) {
    baud.how = verdict::skipped;
    baud.remark = "Nothing came to judge it by.";
  }
  tell(std::move(baud));
  if (is_silent) {
    answer_.find(diagnosis::silent);
    tell(std::move(answer_));
  }
  return goes_on && !ear_.is_over();
}

bool examination::make_quiet() {
  listener to;
  std::uint64_t packets = 0;
  std::uint64_t noise = 0;
  to.event = [&](const heard& came) {
    if (const auto* gone = std::get_if<skipped>(&came.what)) noise += gone->count;
    if (std::holds_alternative<packet_view>(came.what)) ++packets;
  };
  const std::int64_t until_ns = ear_.now_ns() + unasked_ns;
  ear_.listen(until_ns, to);
  bool is_quiet = false;
  bool has_packets = packets > 0;
  packets_ += packets;
  for (int i = 0; i < times_to_stop && !ear_.is_over() && !is_quiet; ++i) {
    packets = 0;
    ear_.send(command::forced_stop);
    ear_.send(command::stop);
    is_quiet = ear_.listen_for_quiet(quiet_ns, ear_.now_ns() + 500 * ms, to);
    packets_ += packets;
    has_packets = has_packets || packets > 0;
  }
  if (has_packets) answer_.find(diagnosis::was_scanning);
  if (packets_ == 0 && ear_.boots() == 0) garbage_ += noise;
  if (is_quiet || ear_.is_over()) return is_quiet;
  is_deaf_ = packets > 0;
  if (is_deaf_) answer_.find(diagnosis::deaf);
  return false;
}

bool examination::first_contact() {
  std::int64_t begin_ns = -1;
  const std::size_t times = first_patience_ns.size();
  for (std::size_t i = 0; i < times + (garbage_ > 0 ? more_times : 0) && !ear_.is_over(); ++i) {
    const std::int64_t patience_ns = i < times ? first_patience_ns.at(i) : more_patience_ns;
    exchange made = ear_.ask(command::device_info, patience_ns);
    if (begin_ns < 0) begin_ns = made.asked_ns;
    if (made.is_answered() || made.wrong > 0) {
      ask_the_rest(std::move(made), begin_ns);
      return true;
    }
    if (made.packets > 0) {
      packets_ += made.packets;
      if (!make_quiet()) return false;
      begin_ns = -1;
      continue;
    }
    if (!made.booted) garbage_ += made.skipped;
  }
  return false;
}

// Where it had to be asked again, it was booting; or the answers are late, and those to the other
// questions come yet.
void examination::ask_the_rest(exchange last, std::int64_t begin_ns) {
  const bool booted = ear_.boots() > 0;
  const std::int64_t longest_ns = last.is_answered() ? last.answered_ns - begin_ns : 0;
  bool is_late = false;
  if (begin_ns != last.asked_ns) {
    answer_.add("first_answer_after_ms", longest_ns / ms);
    listener to;
    to.event = [&](const heard& came) {
      is_late = is_late || std::holds_alternative<response_view>(came.what);
    };
    ear_.listen_for_quiet(longest_ns + 100 * ms, ear_.now_ns() + 10'000 * ms, to);
    is_late = (is_late || last.copies > 0) && !booted;
  }
  if (is_late) last.asked_ns = begin_ns;
  const std::int64_t latency_ns = last.is_answered() && !booted ? last.latency_ns() : 0;
  if (!booted) book_.add(std::move(last));
  ask_all(ear_, book_, latency_ns);
}

// Whether a device that gives no answer starts all the same.
bool examination::scans_when_told() {
  std::uint64_t packets = 0;
  listener to;
  to.event = [&](const heard& came) {
    packets += std::holds_alternative<packet_view>(came.what) ? 1U : 0U;
  };
  ear_.send(command::start);
  const std::int64_t until_ns = ear_.now_ns() + 1'500 * ms;
  ear_.listen(until_ns, to);
  stop();
  return packets > 0;
}

void examination::look_for_the_rate(stage_report& baud) {
  if (garbage_ > 0) baud.add("bytes_without_a_frame", garbage_);
  std::uint32_t found = 0;
  std::string tried;
  for (const std::uint32_t rate : other_rates) {
    if (!options_.at_rate || rate == baud_ || ear_.is_interrupted() || found != 0) continue;
    ear_.replace([&] { return options_.at_rate(rate); });
    if (ear_.is_over()) continue;
    tried += (tried.empty() ? "" : " ") + std::to_string(rate);
    std::uint64_t frames = 0;
    listener to;
    to.event = [&](const heard& came) {
      frames += std::holds_alternative<skipped>(came.what) ? 0U : 1U;
    };
    ear_.send(command::device_info);
    const std::int64_t until_ns = ear_.now_ns() + 400 * ms;
    ear_.listen(until_ns, to);
    if (frames > 0) found = rate;
  }
  if (!tried.empty()) baud.add("rates_tried", tried);
  if (found != 0) baud.add("rate_that_works", found);
  if (found != 0 || garbage_ > 0) baud.find(diagnosis::wrong_baud_rate);
}

bool examination::interview() {
  const auto is_disturbed = [&] {
    return !book_.exchanges().empty() && book_.exchanges().back().packets > 0;
  };
  for (int i = 0; i < 2 && !ear_.is_over() && !is_deaf_ && is_disturbed(); ++i) {
    answer_.find(diagnosis::was_scanning);
    if (make_quiet()) ask_all(ear_, book_, 0);
  }
  if (!book_.exchanges().empty()) book_.judge(answer_);
  if (ear_.boots() > 0) answer_.add("boots", ear_.boots());
  if (ear_.boots() > 1) answer_.find(diagnosis::reboots);
  note_loss(answer_);
  tell(std::move(answer_));
  if (ear_.is_over()) return false;
  portrait_ = book_.portrait();
  return tell_identity() && tell_health();
}

bool examination::tell_identity() {
  stage_report identity{.where = stage::identity};
  const auto& known = portrait_.information;
  if (!known) {
    skip(stage::identity, "It has not said who it is.");
    return true;
  }
  identity.add("model", static_cast<int>(known->model));
  identity.add("firmware",
               std::to_string(known->firmware_major) + "." + std::to_string(known->firmware_minor));
  identity.add("hardware", static_cast<int>(known->hardware));
  identity.add("serial_number",
               std::string(known->serial_digits.begin(), known->serial_digits.end()));
  if (known->model != model_g4) identity.find(diagnosis::other_device);
  const bool is_one = identity.found.empty();
  tell(std::move(identity));
  return is_one;
}

bool examination::tell_health() {
  if (!portrait_.health) {
    skip(stage::health, "It has not said how it is.");
    return true;
  }
  stage_report health{.where = stage::health};
  constexpr std::array<std::string_view, 3> names{"ok", "warning", "error"};
  const auto status = static_cast<std::size_t>(portrait_.health->status);
  health.add("status", text_of(names[std::min<std::size_t>(status, 2)]));
  health.add("error_code", portrait_.health->error_code);
  if (portrait_.health->status == health_status::warning) health.find(diagnosis::health_warning);
  if (portrait_.health->status == health_status::error) health.find(diagnosis::health_error);
  tell(std::move(health));
  return portrait_.health->status != health_status::error;  // such a one is not started
}

bool examination::stop() {
  for (int i = 0; i < times_to_stop && !ear_.is_over(); ++i) {
    ear_.send(command::forced_stop);
    ear_.send(command::stop);
    if (ear_.listen_for_quiet(quiet_ns, ear_.now_ns() + 500 * ms)) return true;
  }
  return false;
}

}  // namespace g4_dump
