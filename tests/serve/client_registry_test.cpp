// SPDX-License-Identifier: MIT
// What the clients of a client registry get, whether they read or not.
#include "client_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "host_guard.hpp"

namespace {

using namespace g4_tool;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string text_in(const outgoing& message) {
  return {message.payload->begin(), message.payload->end()};
}

class ClientRegistry : public ::testing::Test {
 protected:
  /// "op" of each text that waits, "scan" for a binary message; all are taken.
  std::vector<std::string> take_all(client_registry::client& to) {
    std::vector<std::string> all;
    while (const auto message = registry.take(to)) {
      last = text_in(*message);
      all.push_back(message->is_text ? json::parse(last)["op"].get<std::string>() : "scan");
    }
    return all;
  }
  client_registry::client& page() { return *registry.connect(client_kind::page, nullptr); }
  client_registry::client& foxglove() { return *registry.connect(client_kind::foxglove, nullptr); }

  bool allows_set = true;
  int woken = 0;
  std::vector<std::string> commands;
  std::vector<std::function<void(const std::string&)>> done;
  int plays = 0;
  std::string last;
  client_registry registry{"session",
                           true,
                           {.set =
                                [this](const set_request& wanted, auto when_done) {
                                  commands.push_back(wanted.name + '=' + wanted.value);
                                  done.push_back(std::move(when_done));
                                },
                            .play = [this](const play_request&) { ++plays; },
                            .record =
                                [this](const record_request& wanted, auto when_done) {
                                  commands.emplace_back(wanted.is_on ? "record" : "end");
                                  done.push_back(std::move(when_done));
                                }},
                           [this] { ++woken; }};
};

TEST_F(ClientRegistry, NewClients_GetHelloAndStatus) {
  registry.send_hello(R"({"op":"hello"})", true);
  EXPECT_THAT(take_all(page()), ElementsAre("hello", "status"));
  EXPECT_THAT(take_all(foxglove()), ElementsAre("serverInfo", "advertise"));
}

TEST_F(ClientRegistry, Pages_GetWhatIsPublished) {
  client_registry::client& one = page();
  client_registry::client& two = foxglove();
  take_all(one);
  take_all(two);
  EXPECT_EQ(woken, 0);
  registry.page_scan({1, 2});
  registry.status(R"({"op":"status"})");
  registry.settings(R"({"op":"settings"})");
  registry.event(R"({"op":"event"})");
  EXPECT_EQ(woken, 4);
  const std::vector<std::string> got = take_all(one);
  EXPECT_THAT(got, ::testing::UnorderedElementsAre("event", "settings", "status", "scan"));
  EXPECT_EQ(got.front(), "event");
  EXPECT_THAT(take_all(two), ElementsAre());
  EXPECT_EQ(std::string(registry.status()->begin(), registry.status()->end()),
            R"({"op":"status"})");
}

TEST_F(ClientRegistry, SlowPage_GetsTheNewestScan) {
  client_registry::client& slow = page();
  take_all(slow);
  for (std::uint8_t i = 0; i < 200; ++i) registry.page_scan({i});
  EXPECT_THAT(take_all(slow), ElementsAre("scan"));
  EXPECT_EQ(last, std::string(1, '\xC7'));
}

TEST_F(ClientRegistry, PageThatNeverReads_HasABoundedOutbox) {
  client_registry::client& deaf = page();
  for (int i = 0; i < 1000; ++i) {
    registry.event(R"({"op":"event"})");
    EXPECT_TRUE(registry.receive(deaf, R"({"op":"dance"})"));
    registry.send_hello(R"({"op":"hello"})", true);
    registry.page_scan({1});
  }
  EXPECT_LE(take_all(deaf).size(), outbox::longest_queue + outbox::slot_count);
}

TEST_F(ClientRegistry, ARecording_IsAskedForOnceAtATime) {
  client_registry::client& asking = page();
  client_registry::client& other = page();
  take_all(asking);
  take_all(other);
  EXPECT_TRUE(registry.receive(asking, R"({"op":"record","on":true})"));
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(registry.receive(asking, R"({"op":"record","on":false})"));
  }
  EXPECT_THAT(commands, ElementsAre("record"));
  EXPECT_THAT(take_all(asking), ::testing::Each("error"));
  done.at(0)("the disk is full");
  EXPECT_THAT(take_all(asking), ElementsAre("error"));
  EXPECT_EQ(json::parse(last)["of"], "record");
  EXPECT_EQ(json::parse(last)["message"], "the disk is full");
  EXPECT_TRUE(registry.receive(asking, R"({"op":"record","on":false})"));
  EXPECT_THAT(commands, ElementsAre("record", "end"));
  EXPECT_THAT(take_all(other), ElementsAre());
}

TEST_F(ClientRegistry, SlotsTakeTurns) {
  client_registry::client& slow = page();
  take_all(slow);
  std::vector<std::string> got;
  for (int i = 0; i < 4; ++i) {  // a scan comes whenever one message could be sent
    registry.page_scan({1});
    registry.status(R"({"op":"status"})");
    got.push_back(registry.take(slow)->is_text ? "status" : "scan");
  }
  EXPECT_THAT(got, ::testing::UnorderedElementsAre("status", "scan", "status", "scan"));
}

TEST_F(ClientRegistry, Set_IsPassedOnAndAnswered) {
  client_registry::client& one = page();
  client_registry::client& two = page();
  take_all(one);
  take_all(two);
  EXPECT_TRUE(registry.receive(one, R"({"op":"set","name":"frequency","value":9})"));
  EXPECT_THAT(commands, ElementsAre("frequency=9"));
  EXPECT_TRUE(registry.receive(one, R"({"op":"set","name":"frequency","value":8})"));
  EXPECT_THAT(take_all(one), ElementsAre("error")) << "one after the other";
  EXPECT_TRUE(registry.receive(two, R"({"op":"set","name":"frequency","value":7})"));
  done.at(0)("");
  EXPECT_THAT(take_all(one), ElementsAre());
  done.at(1)("refused");
  EXPECT_THAT(take_all(two), ElementsAre("error"));
  EXPECT_THAT(last, HasSubstr("refused"));
  EXPECT_TRUE(registry.receive(one, R"({"op":"set","name":"frequency","value":8})"));
  registry.disconnect(&one);
  done.at(2)("too late");  // nobody hears it
  EXPECT_EQ(commands.size(), 3U);
}

TEST_F(ClientRegistry, Set_IsRefusedUnlessAllowed) {
  client_registry closed(
      "s", false, {.set = [](const set_request&, const auto&) { FAIL(); }, .play = {}}, [] {});
  client_registry::client& one = *closed.connect(client_kind::page, nullptr);
  EXPECT_TRUE(closed.receive(one, R"({"op":"set","name":"frequency","value":9})"));
  EXPECT_THAT(text_in(*closed.take(one)), HasSubstr("--allow-set"));
}

TEST_F(ClientRegistry, Play_IsPassedOn) {
  EXPECT_TRUE(registry.receive(page(), R"({"op":"play","paused":true})"));
  EXPECT_EQ(plays, 1);
}

TEST_F(ClientRegistry, ClientsThatDoNotSpeakTheirProtocol_AreClosed) {
  EXPECT_FALSE(registry.receive(page(), "GET / HTTP/1.1"));
  EXPECT_FALSE(registry.receive(foxglove(), "{"));
}

TEST_F(ClientRegistry, Foxglove_GetsWhatItSubscribes) {
  client_registry::client& one = foxglove();
  take_all(one);
  registry.publish(channel::scan, 5, {1});
  EXPECT_FALSE(registry.has_more(one)) << "not subscribed";
  EXPECT_FALSE(registry.wanted().wants(channel::scan));
  EXPECT_TRUE(registry.receive(
      one,
      R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":1},{"id":8,"channelId":3}]})"));
  EXPECT_TRUE(registry.wanted().wants(channel::scan));
  EXPECT_FALSE(registry.wanted().page);
  registry.publish(channel::scan, 5, {42});
  registry.publish(channel::points, 5, {43});
  const auto message = registry.take(one);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->prefix[0], 1);
  EXPECT_EQ(message->prefix[1], 9);
  EXPECT_EQ(message->prefix[5], 5);
  EXPECT_EQ(text_in(*message), "*");
  EXPECT_FALSE(registry.has_more(one));
  registry.publish(channel::scan, 6, {44});
  EXPECT_TRUE(registry.receive(one, R"({"op":"unsubscribe","subscriptionIds":[9]})"));
  EXPECT_FALSE(registry.has_more(one)) << "nor what waited";
}

TEST_F(ClientRegistry, Foxglove_IsWarnedOfBytesThatAreLeftOut) {
  client_registry::client& slow = foxglove();
  take_all(slow);
  EXPECT_TRUE(registry.receive(
      slow,
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":4}]})"));
  const auto publish = [&] {
    registry.publish(channel::scan, 1, {1});
    registry.publish(channel::from_device, 1, {2});
  };
  for (int i = 0; i < 3; ++i) {
    publish();
    EXPECT_THAT(take_all(slow), ElementsAre("scan", "scan")) << "nothing was left out";
  }
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 50; ++i) publish();
    const auto warning = registry.take(slow);
    ASSERT_TRUE(warning && warning->is_text) << "before the bytes, and once";
    EXPECT_THAT(text_in(*warning), HasSubstr("/g4lidar/from_device are left out"));
    EXPECT_EQ(json::parse(text_in(*warning))["level"], 1);
    EXPECT_THAT(take_all(slow), ElementsAre("scan", "scan"));
  }
}

TEST_F(ClientRegistry, Foxglove_IsWarnedOfWhatCannotBe) {
  client_registry::client& one = foxglove();
  take_all(one);
  const auto expect_warning = [&](const std::string& request, const std::string& why) {
    EXPECT_TRUE(registry.receive(one, request));
    EXPECT_THAT(take_all(one), ElementsAre("status")) << request;
    EXPECT_THAT(last, HasSubstr(why));
  };
  expect_warning(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":5}]})", "no channel 5");
  EXPECT_TRUE(
      registry.receive(one, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})"));
  expect_warning(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})", "there already");
  expect_warning(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":1}]})",
                 "subscribed already");
  expect_warning(R"({"op":"getParameters"})", "getParameters");
}

TEST_F(ClientRegistry, NumberOfClients_IsLimited) {
  std::vector<client_registry::client*> all;
  for (std::size_t i = 0; i < client_registry::most_clients; ++i) {
    all.push_back(registry.connect(client_kind::page, nullptr));
    EXPECT_NE(all.back(), nullptr);
  }
  EXPECT_EQ(registry.connect(client_kind::page, nullptr), nullptr);
  registry.disconnect(all.front());
  EXPECT_NE(registry.connect(client_kind::page, nullptr), nullptr);
  EXPECT_EQ(registry.client_count(), client_registry::most_clients);
}

TEST(HostGuard, LoopbackKnowsItsNames) {
  const host_guard guard("127.0.0.1", {"https://app.foxglove.dev"});
  const auto allows = [&](const char* host, const char* origin = nullptr) {
    return guard.allows(host == nullptr ? std::nullopt : std::optional<std::string>(host),
                        origin == nullptr ? std::nullopt : std::optional<std::string>(origin));
  };
  for (const char* host : {"localhost:8765", "LOCALHOST", "127.0.0.1:8765", "[::1]:8765"}) {
    EXPECT_TRUE(allows(host)) << host;
  }
  for (const char* host :
       {"", "evil.example", "evil.example:8765", "192.168.0.1", "localhost.evil.example",
        "localhost:", "localhost:x", "localhost:123456", "[::1", "local host", "127.0.0.1:80@evil",
        "127.0.0.1\r\nX: y"}) {
    EXPECT_FALSE(allows(host)) << host;
  }
  EXPECT_FALSE(allows(nullptr));
  EXPECT_TRUE(allows("localhost:8765", "http://localhost:8765"));
  EXPECT_TRUE(allows("localhost:8765", "https://app.foxglove.dev"));
  for (const char* origin :
       {"", "null", "http://evil.example", "http://localhost", "http://localhost:8766",
        "http://127.0.0.1:8765", "https://localhost:8765", "https://app.foxglove.dev.evil",
        "http://app.foxglove.dev"}) {
    EXPECT_FALSE(allows("localhost:8765", origin)) << origin;
  }
}

TEST(HostGuard, AllNetworksKnowAddressesInNumbers) {
  const host_guard guard("0.0.0.0", {});
  EXPECT_TRUE(guard.allows("192.168.0.1:8765", std::nullopt));
  EXPECT_TRUE(guard.allows("[fe80::1]:8765", "http://[fe80::1]:8765"));
  EXPECT_FALSE(guard.allows("evil.example:8765", std::nullopt)) << "a name can lead anywhere";
  EXPECT_FALSE(guard.allows("192.168.0.1:8765", "http://evil.example"));
  const host_guard one("192.168.0.7", {});
  EXPECT_TRUE(one.allows("192.168.0.7", std::nullopt));
  EXPECT_FALSE(one.allows("192.168.0.8", std::nullopt));
}

}  // namespace
