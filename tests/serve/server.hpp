// SPDX-License-Identifier: MIT
// The fixture for tests of g4-serve, run by `g4-dump serve`.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "program.hpp"
#include "raw_client.hpp"

namespace serve {

inline constexpr const char* page = "g4lidar.page.v1";

class Server : public cli::scratch {
 protected:
  /// Starts it; returns its port.
  std::uint16_t begin(const std::vector<std::string>& more = {}, const std::string& source = "sim:",
                      const std::string& url = "http://127.0.0.1:") {
    std::vector<std::string> words{"serve", source, "--port", "0"};
    words.insert(words.end(), more.begin(), more.end());
    running_ = std::make_unique<cli::program>(
        words, cli::streams{{}, {}, cli::stream::of_file(path("err"))});
    for (int i = 0; i < 3'000; ++i) {
      const std::string text =
          std::filesystem::exists(path("err")) ? cli::read_file(path("err")) : "";
      const std::size_t at = text.find(url);
      if (at != std::string::npos && text.find('\n', at) != std::string::npos) {
        port_ = static_cast<std::uint16_t>(std::stoi(text.substr(at + url.size())));
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_NE(port_, 0);
    return port_;
  }
  cli::outcome end(int signal = SIGTERM) {
    running_->send(signal);
    return running_->wait();
  }
  /// A page whose handshake is done.
  std::unique_ptr<raw_client> open_page() const {
    auto made = std::make_unique<raw_client>(port_);
    EXPECT_THAT(made->upgrade(page), ::testing::StartsWith("HTTP/1.1 101"));
    return made;
  }
  /// Whether scans come to `client`: so many binary messages.
  static bool gets_scans(raw_client& client, int count = 3) {
    while (count > 0) {
      const auto message = client.next_frame();
      if (!message) return false;
      count -= message->starts_with('\x10') ? 1 : 0;
    }
    return true;
  }
  /// The next text with this "op".
  static nlohmann::json next(raw_client& client, const std::string& op) {
    while (const auto message = client.next_frame()) {
      const auto text = nlohmann::json::parse(*message, nullptr, false);
      if (text.is_object() && text.value("op", "") == op) return text;
    }
    return nullptr;
  }
  std::uint16_t port_ = 0;
  std::unique_ptr<cli::program> running_;
};

}  // namespace serve
