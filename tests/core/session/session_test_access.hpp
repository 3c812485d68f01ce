// SPDX-License-Identifier: MIT
// The equality of two states of a session.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "g4lidar/core/session.hpp"

namespace g4lidar {

/// Reads and changes the state of a session, for the equality of two states. Times are counted from now; values without influence
/// (times of completed operations, counters that are only reported) are set to zero.
struct session_test_access {
  static constexpr std::int64_t horizon = 16;  // more than any of the times below

  static std::int64_t from_now(std::int64_t time, std::int64_t now, bool counts) {
    return counts ? std::clamp(time - now, -horizon, horizon) : 0;
  }

  static void normalise(session& s, std::int64_t now) {
    command_channel& talk = s.channel_;
    using act = command_channel::act;
    const bool boots = talk.act_ == act::booting || talk.act_ == act::probing;
    const bool drains = talk.act_ == act::draining;
    talk.heard_ns_ = from_now(talk.heard_ns_, now, drains || talk.act_ == act::booting);
    talk.deadline_ns_ = from_now(talk.deadline_ns_, now, talk.act_ != act::none);
    talk.is_new_ = talk.is_slow_ = false;  // first_answer_ns is answer_ns here
    talk.slow_from_ns_ = 0;
    talk.boot_until_ns_ = from_now(talk.boot_until_ns_, now, boots);
    talk.queue_ = {};
    talk.queued_ = talk.fetched_ = 0;
    if (!drains) talk.drains_ = 0;
    talk.has_packets_ = talk.has_packets_ && drains;
    talk.has_signs_ = talk.has_signs_ && talk.act_ == act::booting;
    talk.is_old_ = talk.is_old_ && boots;

    scan_supervisor& watch = s.watch_;
    const bool watches = s.scanning_ || talk.act_ == act::starting;
    watch.last_start_ns_ = from_now(watch.last_start_ns_, now, watches);
    watch.since_ns_ =
        from_now(watch.since_ns_, now, s.scanning_ && (watch.restarts_ > 0 || !watch.has_packets_));
    watch.last_packet_ns_ = from_now(watch.last_packet_ns_, now, s.scanning_);
    watch.has_packets_ = watch.has_packets_ && s.scanning_;
    watch.is_reported_ = watch.is_reported_ && s.scanning_ && !watch.has_packets_;
    if (!s.scanning_) watch.restarts_ = 0;
    watch.is_assumed_ = watch.is_assumed_ && !watch.has_packets_;

    request_course& course = s.request_;
    const request asked = course.outcome_.asked;
    course.outcome_ = outcome{request{request_kind::device_info}};
    course.steps_.moves_ = 0;  // bounds the moves of a request: see EndIfNoChangeIsKept
    course.retries_ = 0;
    course.limit_ns_ = horizon;  // never reached: an end by it would only be an earlier one
    if (course.is_running_) {
      course.outcome_.asked = asked;
    } else {
      course.steps_ = request_retry{};
      const std::uint8_t doubt = talk.question_.doubt_;
      talk.question_ = pending_command{};
      talk.question_.doubt_ = doubt;
      course.is_broken_ = false;
      course.disturbances_ = 0;
      if (!s.scanning_) s.starts_ = 0;
    }
  }

  /// Every member.
  static std::string key(const session& s) {
    std::string out;
    const auto add = [&](auto... values) {
      ((out += static_cast<char>(static_cast<int>(values) & 0xFF)), ...);
    };
    const auto add_wide = [&](std::uint16_t value) { add(value & 0xFF, value >> 8); };
    const command_channel& talk = s.channel_;
    add(talk.act_, talk.drains_, talk.has_packets_, talk.has_signs_, talk.is_old_, talk.heard_ns_,
        talk.deadline_ns_, talk.boot_until_ns_);
    const pending_command& question = talk.question_;
    add(question.code_, question.sent_, question.doubt_, question.clears_, question.is_clearing_,
        question.is_early_, question.is_slow_);
    const scan_supervisor& watch = s.watch_;
    add(watch.last_start_ns_, watch.since_ns_, watch.last_packet_ns_,
        watch.protection_ ? static_cast<int>(*watch.protection_) : 2, watch.restarts_,
        watch.has_packets_, watch.is_reported_, watch.is_assumed_);
    const request_course& course = s.request_;
    const request_retry& steps = course.steps_;
    add(steps.wanted_.what, steps.waits_for_, steps.move_, steps.losses_, steps.unmoved_,
        steps.has_origin_, steps.is_known_, steps.has_moved_, steps.denied_, steps.is_coarse_,
        steps.coarse_stuck_, steps.stuck_);
    add_wide(steps.wanted_.value);
    add_wide(steps.origin_);
    add_wide(steps.current_);
    add_wide(steps.before_);
    add(course.outcome_.asked.what, s.notice_, s.resume_, course.is_running_, course.is_done_,
        s.scanning_, s.is_idle_, s.is_runaway_, s.surprise_, course.is_broken_,
        course.disturbances_, s.starts_);
    add_wide(course.outcome_.asked.value);
    return out;
  }
};

}  // namespace g4lidar
