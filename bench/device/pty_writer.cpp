// SPDX-License-Identifier: MIT
#include "pty_writer.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::bench {
namespace {

[[noreturn]] void give_up(const char* what) {
  std::perror(what);
  std::exit(1);
}

void wait_for(int handle, short events, std::int64_t until_ns) {
  const std::int64_t left = std::max<std::int64_t>(until_ns - steady_ns(), 0);
  const timespec time{static_cast<std::time_t>(left / 1'000'000'000),
                      static_cast<long>(left % 1'000'000'000)};
  pollfd ready{handle, events, 0};
  static_cast<void>(ppoll(&ready, 1, &time, nullptr));
}

void write_all(int handle, bytes data) {
  while (!data.empty()) {
    const ssize_t count = ::write(handle, data.data(), data.size());
    if (count > 0) {
      data = data.subspan(static_cast<std::size_t>(count));
    } else {
      wait_for(handle, POLLOUT, steady_ns() + 1'000'000'000);
    }
  }
}

/// The device for both: moves bytes in both directions, once.
class player {
 public:
  explicit player(int master) : master_(master), begin_ns_(steady_ns()) {}

  /// The bytes to send now.
  bytes exchange() {
    const std::int64_t now = steady_ns() - begin_ns_;
    const ssize_t asked = ::read(master_, buffer_.data(), buffer_.size());
    if (asked > 0) device_.write(bytes(buffer_).first(static_cast<std::size_t>(asked)), now);
    return bytes(buffer_).first(device_.read(buffer_, now));
  }
  void wait(std::int64_t end_ns) {
    const std::int64_t next = device_.next_ns(steady_ns() - begin_ns_);
    const bool never = next == sim::forever_ns;
    wait_for(master_, POLLIN, never ? end_ns : std::min(end_ns, begin_ns_ + next));
  }
  [[nodiscard]] bool is_scanning() const noexcept { return device_.is_scanning(); }

 private:
  int master_;
  std::int64_t begin_ns_;
  sim::device device_{sim::built_in_world()};
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace

std::int64_t steady_ns() noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

pty::pty() : master_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) give_up("a pty");
  path_ = ptsname(master_);
  slave_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios raw{};
  if (slave_ < 0 || tcgetattr(slave_, &raw) != 0) give_up("a pty's other end");
  cfmakeraw(&raw);
  if (tcsetattr(slave_, TCSANOW, &raw) != 0) give_up("a pty's settings");
}

pty::~pty() {
  ::close(slave_);
  ::close(master_);
}

void use_processor(unsigned number) noexcept {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(number, &only);
  static_cast<void>(sched_setaffinity(0, sizeof(only), &only));
}

void feed_in_real_time(int master, std::int64_t end_ns,
                       std::vector<std::int64_t>& zero_packets_ns) {
  player g4(master);
  stream_parser parser;
  while (steady_ns() < end_ns) {
    const bytes data = g4.exchange();
    const std::int64_t now = steady_ns();
    parser.feed(data, [&](const event& found) {
      const auto* packet = std::get_if<packet_view>(&found);
      if (packet != nullptr && packet->is_zero()) zero_packets_ns.push_back(now);
    });
    write_all(master, data);
    g4.wait(end_ns);
  }
}

void flood(int master, const std::vector<std::uint8_t>& stream, std::size_t bytes_wanted) {
  player g4(master);
  while (!g4.is_scanning()) {
    write_all(master, g4.exchange());
    g4.wait(steady_ns() + 1'000'000);
  }
  write_all(master, sim::scan_start_reply());
  for (std::size_t sent = 0; sent < bytes_wanted; sent += stream.size()) {
    write_all(master, stream);
  }
}

recording record(std::size_t revolutions) {
  recording made;
  sim::scanner_options options;
  options.start_deg = 0.0;
  sim::scanner scanner(sim::built_in_world(), options);
  while (true) {
    const auto packet = scanner.next();
    if (packet.samples[0].revolution == revolutions) return made;
    made.data.insert(made.data.end(), packet.data.begin(), packet.data.end());
    made.samples += packet.samples.size();
  }
}

}  // namespace g4lidar::bench
