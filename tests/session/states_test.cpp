// SPDX-License-Identifier: MIT
// All states of a session, found by doing in each whatever can be done, and what holds in all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "g4lidar/session.hpp"
#include "session/played.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {

/// What makes two states of a session the same. Time is counted from now; what has no influence any
/// more (times of acts that are over, counters that are only told) is put to nought.
struct session_state {
  static constexpr std::int64_t horizon = 16;  // more than any of the times below

  static std::int64_t from_now(std::int64_t time, std::int64_t now, bool counts) {
    return counts ? std::clamp(time - now, -horizon, horizon) : 0;
  }

  static void normalise(session& s, std::int64_t now) {
    device_talk& talk = s.talk_;
    using act = device_talk::act;
    const bool boots = talk.act_ == act::booting || talk.act_ == act::probing;
    const bool drains = talk.act_ == act::draining;
    talk.heard_ns_ = from_now(talk.heard_ns_, now, drains || talk.act_ == act::booting);
    talk.deadline_ns_ = from_now(talk.deadline_ns_, now, talk.act_ != act::none);
    talk.boot_until_ns_ = from_now(talk.boot_until_ns_, now, boots);
    talk.queue_ = {};
    talk.queued_ = talk.fetched_ = 0;
    if (!drains) talk.drains_ = 0;
    talk.has_packets_ = talk.has_packets_ && drains;
    talk.has_signs_ = talk.has_signs_ && talk.act_ == act::booting;
    talk.is_old_ = talk.is_old_ && boots;

    scan_watch& watch = s.watch_;
    const bool watches = s.scanning_ || talk.act_ == act::starting;
    watch.last_start_ns_ = from_now(watch.last_start_ns_, now, watches);
    watch.since_ns_ = from_now(watch.since_ns_, now, s.scanning_ && watch.restarts_ > 0);
    watch.last_packet_ns_ = from_now(watch.last_packet_ns_, now, s.scanning_);
    watch.has_packets_ = watch.has_packets_ && s.scanning_;
    if (!s.scanning_) watch.restarts_ = 0;

    const request asked = s.outcome_.asked;
    s.outcome_ = outcome{request{ask::device_info}};
    s.steps_.moves_ = 0;  // bounds the moves of a request: see EndThoughNoMoveEverHolds
    s.retries_ = 0;
    s.limit_ns_ = horizon;  // never comes: an end by it would only be an earlier one
    if (s.has_request_) {
      s.outcome_.asked = asked;
    } else {
      s.steps_ = request_steps{};
      const std::uint8_t doubt = talk.question_.doubt_;
      talk.question_ = pending_question{};
      talk.question_.doubt_ = doubt;
      s.is_broken_ = false;
      s.disturbances_ = 0;
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
    const device_talk& talk = s.talk_;
    add(talk.act_, talk.drains_, talk.has_packets_, talk.has_signs_, talk.is_old_, talk.heard_ns_,
        talk.deadline_ns_, talk.boot_until_ns_);
    const pending_question& question = talk.question_;
    add(question.code_, question.sent_, question.doubt_, question.clears_, question.is_clearing_,
        question.is_early_, question.is_slow_);
    const scan_watch& watch = s.watch_;
    add(watch.last_start_ns_, watch.since_ns_, watch.last_packet_ns_,
        watch.protection_ ? static_cast<int>(*watch.protection_) : 2, watch.restarts_,
        watch.has_packets_);
    const request_steps& steps = s.steps_;
    add(steps.wanted_.what, steps.waits_for_, steps.move_, steps.losses_, steps.unmoved_,
        steps.has_origin_, steps.is_known_, steps.has_moved_, steps.denied_, steps.is_coarse_,
        steps.coarse_stuck_, steps.stuck_);
    add_wide(steps.wanted_.value);
    add_wide(steps.origin_);
    add_wide(steps.current_);
    add_wide(steps.before_);
    add(s.outcome_.asked.what, s.notice_, s.resume_, s.has_request_, s.is_done_, s.scanning_,
        s.is_idle_, s.is_runaway_, s.surprise_, s.is_broken_, s.disturbances_, s.starts_);
    add_wide(s.outcome_.asked.value);
    return out;
  }
};

namespace test {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

constexpr session_times short_times() {
  session_times times;
  times.answer_ns = 2;
  times.start_ns = 2;
  times.quiet_ns = 1;
  times.drain_ns = 2;
  times.boot_sign_ns = 3;
  times.boot_ns = 5;
  times.feed_ns = 2;
  times.protected_ns = 4;
  times.first_packet_ns = 3;
  times.stall_ns = 2;
  times.request_ns = 1'000'000;
  return times;
}

const std::vector<request>& all_requests() {
  static const std::vector<request> all{
      requests::device_info(),
      requests::health(),
      requests::get_low_power(),
      requests::set(low_power::on),
      requests::set(low_power::off),
      requests::get_direction(),
      requests::set(motor_direction::clockwise),
      requests::set(motor_direction::counter_clockwise),
      requests::get_scan_frequency(),
      requests::step(frequency_step::up_0_1_hz),
      requests::set(scan_frequency{710}),
      requests::set(constant_frequency::on),
      requests::set(constant_frequency::off),
      requests::get_ranging(),
      requests::set(ranging_frequency::khz_9),
      requests::set(power_down_protection::on),
      requests::set(power_down_protection::off),
      requests::restart(),
      requests::start(),
      requests::stop(),
  };
  return all;
}

struct named_reply {
  std::string name;
  buffer frame;
};

const std::vector<named_reply>& all_replies() {
  static const std::vector<named_reply> all{
      {"<header", header_reply()},         {"<info", info_reply()},
      {"<health", health_reply(0)},        {"<byte:0", byte_reply(0)},
      {"<byte:1", byte_reply(1)},          {"<byte:2", byte_reply(2)},
      {"<freq:700", frequency_reply(700)}, {"<freq:710", frequency_reply(710)},
      {"<freq:810", frequency_reply(810)}};
  return all;
}

[[nodiscard]] bool moves_state(command code) {
  const auto traits = traits_of(code);
  return traits && traits->moves_state;
}

/// A session and what an onlooker at the line has seen.
struct watched {
  session talk{short_times()};
  std::int64_t now = 0;
  command move_out = command::stop;  // a moving command that nothing has answered yet; stop: none
  bool stopped = false;              // the last stop came after the last start
  std::int64_t silence = 0;          // since the last stop or packet, up to quiet_ns
  bool asked = false;                // a request has been taken and has no outcome yet

  void pass(std::int64_t time) {
    now += time;
    silence = std::min(silence + time, short_times().quiet_ns);
  }

  void show(const buffer& reply) {
    if (move_out != command::stop && can_answer(move_out, *response_view::from(reply))) {
      move_out = command::stop;
    }
    take_reply(talk, reply, now);
    look_at_line();
  }
  void show_packet() {
    silence = 0;
    take_packet(talk, now);
    look_at_line();
  }
  void look(std::int64_t time) {
    pass(time);
    talk.look(now);
    look_at_line();
  }
  bool begin(const request& wanted, while_scanning how) {
    const bool was_scanning = talk.is_scanning();
    const auto refused = talk.begin(wanted, now, how);
    const bool disturbs = wanted.what != ask::start && wanted.what != ask::stop;
    if (refused) {
      EXPECT_TRUE(was_scanning && disturbs && how == while_scanning::refuse);
      EXPECT_EQ(*refused, refusal::scanning);
      return false;
    }
    asked = true;
    look_at_line();
    return true;
  }

  void look_at_line() {
    while (const auto sent = talk.to_send()) saw(static_cast<command>((*sent)[1]));
    static_cast<void>(talk.noticed());
    if (talk.finished()) {
      EXPECT_TRUE(asked) << "an outcome that nobody waits for";
      asked = false;
    }
    EXPECT_FALSE(talk.finished());
    EXPECT_EQ(talk.is_busy(), asked);
    EXPECT_GE(talk.next_look_ns(), now - short_times().request_ns);
  }

  void saw(command code) {
    const bool is_silent = stopped && silence >= short_times().quiet_ns;
    switch (code) {
      case command::forced_stop:
        return;
      case command::stop:
        stopped = true;
        silence = 0;
        return;
      case command::start:
        EXPECT_TRUE(is_silent || talk.protection() == power_down_protection::on);
        stopped = false;
        return;
      default:
        EXPECT_TRUE(is_silent) << "command " << static_cast<int>(code) << " into a stream";
    }
    if (moves_state(code)) {
      EXPECT_EQ(move_out, command::stop) << "moved on blindly";
      move_out = code;
    } else {
      move_out = command::stop;  // what comes after it has been read back or cleared
    }
  }

  void normalise() {
    session_state::normalise(talk, now);
    now = 0;
  }
  [[nodiscard]] std::string key() const {
    std::string out = session_state::key(talk);
    out += static_cast<char>(move_out);
    out += static_cast<char>(2 * silence + (stopped ? 1 : 0));
    return out;
  }
};

/// Nothing comes any more: the request ends, and a scan is given up.
std::int64_t expect_end(watched at) {
  std::int64_t ended = 0;
  int looks = 0;
  while (at.talk.next_look_ns() != never && looks < 400) {
    at.look(std::max<std::int64_t>(at.talk.next_look_ns() - at.now, 0));
    if (at.asked) ended = at.now;
    ++looks;
  }
  EXPECT_LT(looks, 400) << "no end";
  EXPECT_FALSE(at.talk.is_busy());
  EXPECT_FALSE(at.talk.is_scanning());
  return ended;
}

/// A stop ends in silence, whatever was before.
void expect_stop(watched at) {
  if (at.asked || !at.begin(requests::stop(), while_scanning::refuse)) return;
  EXPECT_TRUE(at.stopped);
  at.look(short_times().quiet_ns);
  EXPECT_FALSE(at.asked);
  EXPECT_FALSE(at.talk.is_scanning());
  EXPECT_EQ(at.talk.next_look_ns(), never);
}

class explorer {
 public:
  explicit explorer(std::vector<request> wanted) : wanted_(std::move(wanted)) {
    add(watched{}, "");
  }

  /// Goes through all states, or as many.
  void go(std::size_t most) {
    for (std::size_t at = 0; at < found_.size() && at < most; ++at) {
      const watched from = found_[at];
      from_ = at;
      longest_ = std::max(longest_, expect_end(from));
      expect_stop(from);
      spread(from);
      if (::testing::Test::HasFailure()) {
        ADD_FAILURE() << "after" << way_to(at);
        return;
      }
      done_ = at + 1;
    }
  }
  [[nodiscard]] std::size_t states() const { return found_.size(); }
  [[nodiscard]] bool is_complete() const { return done_ == found_.size(); }
  [[nodiscard]] std::int64_t longest() const { return longest_; }

 private:
  struct origin {
    std::size_t from;
    std::string deed;
  };

  void add(watched found, const std::string& deed) {
    found.normalise();
    if (!known_.insert(found.key()).second) return;
    found_.push_back(found);
    origins_.push_back({from_, deed});
  }

  template <class Deed>
  void after(const watched& from, const std::string& name, Deed deed) {
    watched next = from;
    deed(next);
    if (::testing::Test::HasFailure()) ADD_FAILURE() << "by " << name;
    add(next, name);
  }

  /// What was done from the beginning to state `at`.
  [[nodiscard]] std::string way_to(std::size_t at) const {
    return at == 0 ? std::string() : way_to(origins_[at].from) + ' ' + origins_[at].deed;
  }

  void spread(const watched& from) {
    for (const named_reply& heard : all_replies()) {
      after(from, heard.name, [&](watched& next) { next.show(heard.frame); });
    }
    after(from, "<packet", [](watched& next) { next.show_packet(); });
    after(from, "<noise", [](watched& next) {
      take_noise(next.talk, next.now);
      next.look_at_line();
    });
    after(from, "+1", [](watched& next) { next.look(1); });
    after(from, "+20", [](watched& next) { next.look(20); });  // the caller has slept
    if (from.asked) return;
    for (const request& wanted : wanted_) {
      for (const auto how : {while_scanning::refuse, while_scanning::stop_and_resume}) {
        const std::string name = "ask" + std::to_string(static_cast<int>(wanted.what));
        after(from, name,
              [&wanted, how](watched& next) { static_cast<void>(next.begin(wanted, how)); });
      }
    }
  }

  std::vector<request> wanted_;
  std::vector<watched> found_;
  std::vector<origin> origins_;
  std::unordered_set<std::string> known_;
  std::size_t from_ = 0;
  std::size_t done_ = 0;
  std::int64_t longest_ = 0;
};

/// Once nothing comes any more: silence, a question, the clearing of the line with its last wait
/// twice as long, and a scan that is resumed, sent three times; or a restart in both ways.
constexpr std::int64_t longest_wait() {
  const session_times times = short_times();
  const std::int64_t asking = 2 * times.answer_ns + 4 * times.answer_ns;
  const std::int64_t booting = times.boot_sign_ns + times.boot_ns + times.answer_ns;
  return 4 * times.quiet_ns + std::max(asking, booting) + 3 * times.start_ns;
}

/// The largest of them are gone through wholly at a larger scale only, and where all takes ten times
/// as long (without optimisation, with sanitizers, under an emulator) only the nearest of all.
#if defined(G4LIDAR_EMULATED) || !defined(__OPTIMIZE__)
constexpr int most_states = 12'000;
#else
constexpr int most_states = 200'000;
#endif

class session_states : public ::testing::TestWithParam<request> {};

TEST_P(session_states, AreNoDeadEndsAndNeverMoveBlindlyNorDisturbAStream) {
  explorer all({GetParam(), requests::start(), requests::stop()});
  const auto most = static_cast<std::size_t>(scaled(most_states));
  all.go(most);
  EXPECT_TRUE(all.is_complete() || all.states() > most);
  EXPECT_LE(all.longest(), longest_wait());
  RecordProperty("states", std::to_string(all.states()));
}

INSTANTIATE_TEST_SUITE_P(of, session_states, ::testing::ValuesIn(all_requests()),
                         [](const auto& wanted) {
                           return "request_" + std::to_string(static_cast<int>(wanted.param.what)) +
                                  "_to_" + std::to_string(wanted.param.value);
                         });

}  // namespace
}  // namespace test
}  // namespace g4lidar
