// SPDX-License-Identifier: MIT
// A lidar whose packets never make a revolution: the part of a session of a COIN-D4 that has no zero packet, again and
// again.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "program.hpp"
#include "recording.hpp"
#include "transport/pty.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;

/// Sends the same packets on a pseudo-terminal again and again, at 9 kHz on average: what a pause holds up follows it.
class endless_device {
 public:
  explicit endless_device(std::string data) : data_(std::move(data)) {
    pty_.make_raw();
    EXPECT_EQ(::fcntl(pty_.master(), F_SETFL, O_NONBLOCK), 0);
    thread_ = std::thread([this] { serve(); });
  }
  endless_device(const endless_device&) = delete;
  endless_device& operator=(const endless_device&) = delete;
  ~endless_device() {
    ends_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& path() const { return pty_.path(); }

 private:
  void serve() {
    using clock = std::chrono::steady_clock;
    constexpr double bytes_per_second = 9000.0 / 40 * 90;
    const auto begin = clock::now();
    std::size_t all = 0;
    while (!ends_) {
      static_cast<void>(::poll(nullptr, 0, 2));
      const std::chrono::duration<double> passed = clock::now() - begin;
      while (static_cast<double>(all) < bytes_per_second * passed.count()) {
        // What the driver writes is not read: it answers nothing.
        const std::size_t from = all % data_.size();
        const ssize_t sent = ::write(pty_.master(), data_.data() + from, data_.size() - from);
        if (sent <= 0) break;
        all += static_cast<std::size_t>(sent);
      }
    }
  }

  std::string data_;
  g4lidar::test::pty pty_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

/// Three packets of a head that turns at 7 Hz, and measures at 9 kHz: 0.28 degrees from one sample to the next.
std::string part_of_a_turn() {
  const std::vector<std::uint16_t> samples(40, 4000);
  std::string all;
  for (int i = 0; i < 3; ++i) all += cli::packet(223 + 11.2 * i, 223 + 11.2 * i + 10.92, samples);
  return all;
}

TEST(NoRevolution, AScanThatIsCounted_EndsWithAnError) {
  const endless_device device(part_of_a_turn());
  const outcome done = run({"scan", "-n", "1", "--listen", "--model", "g4", device.path()});
  EXPECT_EQ(done.code, 9) << done.err;
  EXPECT_THAT(done.err, HasSubstr("10 s of packets make no whole revolution"));
}

/// Pieces are wanted, or the user has set the end.
TEST(NoRevolution, APieceOrADuration_EndsItAsBefore) {
  const endless_device device(part_of_a_turn());
  const outcome piece =
      run({"scan", "-n", "1", "--partial", "--listen", "--model", "g4", device.path()});
  EXPECT_EQ(piece.code, 0) << piece.err;
  EXPECT_THAT(piece.out, HasSubstr("partial"));
  const outcome timed =
      run({"scan", "-n", "1", "-d", "300ms", "--listen", "--model", "g4", device.path()});
  EXPECT_EQ(timed.code, 0) << timed.err;
}

}  // namespace
