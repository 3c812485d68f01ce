// SPDX-License-Identifier: MIT
// More clients of g4-serve than it has places for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "client_registry.hpp"
#include "server.hpp"

namespace {

using serve::page;
using serve::raw_client;
using serve::Server;
using ::testing::StartsWith;

class Crowd : public Server {
 protected:
  static constexpr std::size_t places = g4_tool::client_registry::most_clients;

  using clients = std::vector<std::unique_ptr<raw_client>>;
  clients open_pages(std::size_t count) const {
    clients all;
    while (all.size() < count) all.push_back(open_page());
    return all;
  }
};

// RFC 6455, 7.4: 1013 is "try again later".
const std::string refusal = "\x03\xF5the server has 128 clients already";

TEST_F(Crowd, TwoHundredThatStay_TheFirst128AreServed) {
  begin();
  const clients all = open_pages(200);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i < places) {
      ASSERT_TRUE(gets_scans(*all[i], 1)) << i;
    } else {
      ASSERT_EQ(all[i]->next_frame().value_or("closed"), refusal) << i;
    }
  }
  // One that asks for something at once, and never reads.
  const auto loud = open_page();
  for (int i = 0; i < 100; ++i) loud->send_text(R"({"op":"play","paused":false})");
  EXPECT_TRUE(gets_scans(*all.front(), 3));
  EXPECT_TRUE(gets_scans(*all[places - 1], 3));
  EXPECT_EQ(loud->next_frame().value_or("closed"), refusal);
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Crowd, FiveHundred_AllAreAnswered) {
  begin();
  const auto first = open_page();
  std::vector<raw_client> all;
  for (int i = 0; i < 500; ++i) {
    all.emplace_back(port_);
    all.back().send(raw_client::upgrade_request(page));
  }
  int opened = 0;
  for (raw_client& each : all) {
    const std::string head = each.read_until("\r\n\r\n");
    if (head.starts_with("HTTP/1.1 101")) {
      ++opened;
    } else {
      EXPECT_THAT(head, StartsWith("HTTP/1.1 503"));
    }
  }
  EXPECT_GE(opened, static_cast<int>(places) - 1);
  EXPECT_TRUE(gets_scans(*first));
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Crowd, RequestsOfAPause_AreReadBeforeOthersTakeTheirPlaces) {
  begin();
  const std::string request = "GET /status.json HTTP/1.1\r\nHost: localhost\r\n\r\n";
  std::vector<raw_client> all;
  for (int i = 0; i < 58; ++i) all.emplace_back(port_);
  raw_client last(port_);
  last.send(request);
  ASSERT_THAT(last.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 200"));  // all are accepted
  running_->send(SIGSTOP);
  for (int i = 0; i < 10; ++i) all.emplace_back(port_);
  for (auto each = all.rbegin(); each != all.rend(); ++each) each->send(request);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  running_->send(SIGCONT);
  for (raw_client& each : all) {
    EXPECT_THAT(each.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Crowd, OnesThatEnd_MakeRoomForTheNext) {
  begin();
  for (int round = 0; round < 5; ++round) {
    const clients all = open_pages(100);
    for (const auto& each : all) ASSERT_TRUE(gets_scans(*each, 1)) << round;
  }
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Crowd, ClosedOnesThatKeepTheirSocket_MakeRoom) {
  begin();
  const clients all = open_pages(places);
  for (const auto& each : all) each->send(raw_client::frame(8, "\x03\xE8"));
  EXPECT_TRUE(gets_scans(*open_page(), 3));
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

}  // namespace
