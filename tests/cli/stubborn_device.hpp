// SPDX-License-Identifier: MIT
// A device on a pseudo-terminal that always sends the same answers.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "transport/pty.hpp"

namespace cli {

/// What a G4 answers to the question for its device information: header, model, firmware, hardware, serial.
inline std::string device_information() {
  return {"\xA5\x5A\x14\0\0\0\x04\x05\x02\x03\x03\x02\0\x02\x01\x01\0\x01\0\0\0\0\x07\0\0\x07\x03",
          27};
}

/// Answers every G4's questions, but what is set stays as it is: 7 Hz, 9 kHz.
class stubborn_device {
 public:
  explicit stubborn_device(std::string information = device_information())
      : information_(std::move(information)) {
    pty_.make_raw();
    thread_ = std::thread([this] { serve(); });
  }
  stubborn_device(const stubborn_device&) = delete;
  stubborn_device& operator=(const stubborn_device&) = delete;
  ~stubborn_device() {
    ends_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& path() const { return pty_.path(); }

 private:
  void serve() {
    pollfd waiting{pty_.master(), POLLIN, 0};
    bool has_start = false;
    while (!ends_) {
      unsigned char byte = 0;
      if (::poll(&waiting, 1, 20) <= 0 || ::read(pty_.master(), &byte, 1) != 1) continue;
      if (std::exchange(has_start, !has_start && byte == 0xA5)) answer(byte);
    }
  }
  void answer(unsigned char code) const {
    switch (code) {
      case 0x90:
        return send(information_);
      case 0x91:
        return send({"\xA5\x5A\x03\0\0\0\x06\0\0\0", 10});
      case 0xD0:
      case 0xD1:
        return send({"\xA5\x5A\x01\0\0\0\x04\x02", 8});
      case 0x09:
      case 0x0A:
      case 0x0B:
      case 0x0C:
      case 0x0D:
        return send({"\xA5\x5A\x04\0\0\0\x04\xBC\x02\0\0", 11});
      default:
        return;
    }
  }
  void send(std::string_view bytes) const { pty_.send(bytes); }

  std::string information_;
  g4lidar::test::pty pty_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace cli
