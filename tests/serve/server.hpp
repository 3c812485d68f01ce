// SPDX-License-Identifier: MIT
// The fixture for tests of g4-serve, run by `g4-dump serve`.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "program.hpp"
#include "raw_client.hpp"
#include "support/patience.hpp"

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
    EXPECT_TRUE(g4lidar::test::comes_true([&] {
      if (!std::filesystem::exists(path("err"))) return false;
      const std::string text = cli::read_file(path("err"));
      const std::size_t at = text.find(url);
      if (at == std::string::npos || text.find('\n', at) == std::string::npos) return false;
      port_ = static_cast<std::uint16_t>(std::stoi(text.substr(at + url.size())));
      return true;
    }));
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
    while (count > 0 && next_message(client, [](const std::string& message) {
             return message.starts_with('\x10');
           })) {
      --count;
    }
    return count == 0;
  }
  /// The next text with this "op".
  static nlohmann::json next(raw_client& client, const std::string& op) {
    nlohmann::json text = nullptr;
    const auto is_wanted = [&](const std::string& message) {
      text = nlohmann::json::parse(message, nullptr, false);
      return text.is_object() && text.value("op", "") == op;
    };
    return next_message(client, is_wanted) ? text : nullptr;
  }
  std::uint16_t port_ = 0;
  std::unique_ptr<cli::program> running_;

 private:
  /// Others come all the time: it is this wait that has the limit.
  static std::optional<std::string> next_message(
      raw_client& client, const std::function<bool(const std::string&)>& is_wanted) {
    const auto end = std::chrono::steady_clock::now() + g4lidar::test::patience;
    while (std::chrono::steady_clock::now() < end) {
      auto message = client.next_frame();
      if (!message || is_wanted(*message)) return message;
    }
    return std::nullopt;
  }
};

}  // namespace serve
