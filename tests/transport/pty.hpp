// SPDX-License-Identifier: MIT
// A pseudo-terminal: its slave is the port under test, its master takes the role of the device.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/transport/serial_port.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

class pty {
 public:
  pty() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    EXPECT_GE(master_, 0);
    EXPECT_EQ(::grantpt(master_), 0);
    EXPECT_EQ(::unlockpt(master_), 0);
    path_ = ::ptsname(master_);
    keep_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  pty(const pty&) = delete;
  pty& operator=(const pty&) = delete;
  ~pty() {
    unplug();
    ::close(keep_);
  }

  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] int master() const noexcept { return master_; }
  /// A second descriptor of the slave, which keeps its settings while no program has it open.
  [[nodiscard]] int keep() const noexcept { return keep_; }

  /// As a port that a program has set up: nothing comes back, and no byte is changed.
  void make_raw() const {
    termios raw{};
    EXPECT_EQ(::tcgetattr(keep_, &raw), 0);
    ::cfmakeraw(&raw);
    EXPECT_EQ(::tcsetattr(keep_, TCSANOW, &raw), 0);
  }

  void unplug() noexcept {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }

  /// From the device to the port.
  void send(std::string_view text) const {
    EXPECT_EQ(::write(master_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  /// What the port has sent: at least `size` bytes, if they arrive within ten seconds.
  [[nodiscard]] std::string receive(std::size_t size) const {
    std::string all;
    char piece[4096];
    pollfd polled{master_, POLLIN, 0};
    while (all.size() < size && ::poll(&polled, 1, patience_ms) > 0) {
      const ssize_t got = ::read(master_, piece, sizeof piece);
      if (got <= 0) break;
      all.append(piece, static_cast<std::size_t>(got));
    }
    return all;
  }

 private:
  int master_;
  int keep_ = -1;
  std::string path_;
};

/// Its slave as a port.
inline std::unique_ptr<transport> opened(const pty& device, const serial_options& options = {}) {
  auto port = serial_port::open(device.path(), options);
  EXPECT_TRUE(port) << port.error().message();
  return *std::move(port);
}

inline std::size_t open_descriptors() {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    static_cast<void>(entry);
    ++count;
  }
  return count;
}

}  // namespace g4lidar::test
