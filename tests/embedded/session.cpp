// SPDX-License-Identifier: MIT
// Short dialogues with a device that the test plays.
#include "g4lidar/core/session.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include "check.hpp"

namespace self_test {
namespace {

using namespace g4lidar;

constexpr std::int64_t ms = 1'000'000;
constexpr std::array<std::uint8_t, 7> header{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81};
constexpr std::array<std::uint8_t, 27> info{0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5, 2, 3, 3, 2, 0, 2,
                                            1,    1,    0,    1, 0, 0, 0, 0, 7, 0, 0, 7, 3};

/// A connection on which 1 ms passes between any two events.
class dialogue {
 public:
  [[nodiscard]] bool begins(const request& wanted) {
    return !channel_.begin(wanted, unknown(now_ns_));
  }
  [[nodiscard]] bool sends(std::uint8_t code) {
    const auto sent = channel_.to_send();
    return sent && *sent == std::array<std::uint8_t, 2>{0xA5, code};
  }
  [[nodiscard]] bool sends_nothing() { return !channel_.to_send(); }
  void hears(bytes response) {
    now_ns_ += ms;
    if (const auto reply = response_view::from(unknown(response)))
      channel_.take(event(*reply), now_ns_);
  }
  void hears_byte(std::uint8_t value) {
    const std::array<std::uint8_t, 8> response{0xA5, 0x5A, 1, 0, 0, 0, 4, value};
    hears(response);
  }
  void waits() {
    now_ns_ = channel_.next_look_ns();
    channel_.look(now_ns_);
  }
  [[nodiscard]] bool ends(verdict how) {
    last_ = channel_.finished();
    return last_ && last_->how == how;
  }
  [[nodiscard]] const answer& value() const { return last_->value; }
  [[nodiscard]] const session& talk() const { return channel_; }

 private:
  session channel_;
  std::optional<outcome> last_;
  std::int64_t now_ns_ = 5'000'000'000 * ms;  // a board with a long uptime
};

void test_lost_step() {
  dialogue line;
  check(line.begins(requests::set(sample_rate::khz_9)));
  check(line.sends(0x00) && line.sends(0x65) && line.sends_nothing());
  line.waits();
  check(line.sends(0x90));
  line.hears(info);
  check(line.sends(0xD1));
  line.hears_byte(1);
  check(line.sends(0xD0));
  line.waits();  // the answer is lost: the link is cleared and the setting queried
  check(line.sends(0x90));
  line.hears_byte(2);
  line.hears(info);
  check(line.sends(0xD1));
  line.hears_byte(2);
  check(line.sends(0x90));
  line.hears(info);
  check(line.sends(0xD1));
  line.hears_byte(2);
  if (!check(line.ends(verdict::answered))) return;
  const auto* const reached = std::get_if<sample_rate>(&line.value());
  check(reached != nullptr && *reached == sample_rate::khz_9);
  check(line.talk().retries() == 1);
}

void test_scan() {
  dialogue line;
  check(line.begins(requests::start()));
  check(line.sends(0x00) && line.sends(0x65));
  line.waits();
  check(line.sends(0x60));
  line.hears(header);
  check(line.ends(verdict::answered) && line.talk().is_scanning());
  check(!line.begins(requests::health()));
  check(line.begins(requests::stop()));
  check(line.sends(0x00) && line.sends(0x65));
  line.waits();
  check(line.ends(verdict::answered) && !line.talk().is_scanning());
}

void test_silence() {
  dialogue line;
  check(line.begins(requests::device_info()));
  for (int i = 0; i < 10 && line.talk().is_busy() && !line.ends(verdict::timed_out); ++i) {
    line.waits();
  }
  check(!line.talk().is_busy());
}

}  // namespace

void test_session() {
  test_lost_step();
  test_scan();
  test_silence();
}

}  // namespace self_test
