// SPDX-License-Identifier: MIT
// All reachable states of a session, found by trying every action in each, and the properties of
// all.
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

#include "core/session/played.hpp"
#include "core/session/session_test_access.hpp"
#include "g4lidar/core/session.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::test {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

constexpr session_times short_times() {
  session_times times;
  times.answer_ns = 2;
  times.first_answer_ns = 2;
  times.start_ns = 2;
  times.quiet_ns = 1;
  times.drain_ns = 2;
  times.boot_sign_ns = 3;
  times.boot_ns = 5;
  times.keep_alive_ns = 2;
  times.protected_ns = 4;
  times.spin_up_notice_ns = 1;
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
      requests::get_sample_rate(),
      requests::set(sample_rate::khz_9),
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

/// A session and what an observer of the connection has seen.
struct watched {
  session talk{short_times()};
  std::int64_t now = 0;
  command move_out =
      command::stop;         // a command that changes state and is not answered yet; stop: none
  bool stopped = false;      // the last stop came after the last start
  std::int64_t silence = 0;  // since the last stop or packet, up to quiet_ns
  bool streamed = false;     // a packet arrived since the last start after silence
  bool asked = false;        // a request was accepted and has no outcome yet

  void pass(std::int64_t time) {
    now += time;
    silence = std::min(silence + time, short_times().quiet_ns);
  }

  void show(const buffer& reply) {
    if (move_out != command::stop && can_answer(move_out, *response_view::from(reply))) {
      move_out = command::stop;
    }
    take_reply(talk, reply, now);
    observe_transport();
  }
  void show_packet() {
    silence = 0;
    streamed = true;
    take_packet(talk, now);
    observe_transport();
  }
  void look(std::int64_t time) {
    pass(time);
    talk.look(now);
    observe_transport();
  }
  bool begin(const request& wanted, while_scanning how) {
    const bool was_scanning = talk.is_scanning();
    const auto refused = talk.begin(wanted, now, how);
    const bool disturbs = wanted.what != request_kind::start && wanted.what != request_kind::stop;
    if (refused) {
      EXPECT_TRUE(was_scanning && disturbs && how == while_scanning::refuse);
      EXPECT_EQ(*refused, refusal::scanning);
      return false;
    }
    asked = true;
    observe_transport();
    return true;
  }

  void observe_transport() {
    while (const auto sent = talk.to_send()) saw(static_cast<command>((*sent)[1]));
    static_cast<void>(talk.noticed());
    if (talk.finished()) {
      EXPECT_TRUE(asked) << "an outcome without a request";
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
      case command::start:  // also where nothing follows the scan header: the protection may be on
        EXPECT_TRUE(is_silent || !streamed || talk.protection() == power_down_protection::on);
        streamed = streamed && !is_silent;
        stopped = false;
        return;
      default:
        EXPECT_TRUE(is_silent) << "command " << static_cast<int>(code) << " into a stream";
    }
    if (moves_state(code)) {
      EXPECT_EQ(move_out, command::stop) << "moved on blindly";
      move_out = code;
    } else {
      move_out = command::stop;  // the following is queried or cleared
    }
  }

  void normalise() {
    session_test_access::normalise(talk, now);
    now = 0;
  }
  [[nodiscard]] std::string key() const {
    std::string out = session_test_access::key(talk);
    out += static_cast<char>(move_out);
    out += static_cast<char>(4 * silence + (streamed ? 2 : 0) + (stopped ? 1 : 0));
    return out;
  }
};

/// Nothing arrives any more: the request ends, and a scan is given up.
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

/// A stop ends in silence in every case.
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

  /// Visits all states, or a maximum number.
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

  /// The actions from the beginning to state `at`.
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
      next.observe_transport();
    });
    after(from, "+1", [](watched& next) { next.look(1); });
    after(from, "+20", [](watched& next) { next.look(20); });  // the caller was suspended
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

/// The limit after the last byte: silence, a query, the clearing of the link with its last wait
/// twice as long, and a scan that is resumed, started three times; or a restart with both commands.
constexpr std::int64_t longest_wait() {
  const session_times times = short_times();
  const std::int64_t asking = 2 * times.first_answer_ns + 4 * times.first_answer_ns;
  const std::int64_t booting = times.boot_sign_ns + times.boot_ns + times.first_answer_ns;
  return 4 * times.quiet_ns + std::max(asking, booting) + 3 * times.start_ns;
}

/// The largest requests are explored completely at a larger scale only. Where everything takes ten
/// times as long (without optimisation, with sanitizers, under an emulator) only the nearest states
/// of all requests are explored.
#if defined(G4LIDAR_EMULATED) || !defined(__OPTIMIZE__)
constexpr int most_states = 12'000;
#else
constexpr int most_states = 200'000;
#endif

class session_states : public ::testing::TestWithParam<request> {};

TEST_P(session_states, EndInBoundedTimeAndNeverDisturbAStream) {
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
}  // namespace g4lidar::test
