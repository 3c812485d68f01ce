// SPDX-License-Identifier: MIT
// g4-serve, run by `g4-dump serve`, with clients of every kind: those that keep the rules, and those that do not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "program.hpp"
#include "raw_client.hpp"
#include "server.hpp"
#include "support/patience.hpp"
#include "support/test_scale.hpp"

namespace {

using cli::outcome;
using nlohmann::json;
using serve::page;
using serve::raw_client;
using serve::Server;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST_F(Server, PageAndStatus) {
  begin();
  const std::string answer = raw_client(port_).get("/");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(answer, HasSubstr("content-security-policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(answer, HasSubstr("x-content-type-options: nosniff\r\n"));
  EXPECT_THAT(answer, HasSubstr("cache-control: no-store\r\n"));
  EXPECT_THAT(answer, HasSubstr("<title>"));
  const std::string script = raw_client(port_).get("/main.js");
  EXPECT_EQ(script.substr(script.find("\r\n\r\n") + 4),
            cli::read_file(std::string(G4LIDAR_SOURCE_DIR) + "/tools/g4-serve/page/main.js"));
  EXPECT_THAT(raw_client(port_).get("/../main.cpp"), Not(StartsWith("HTTP/1.1 200")));
  EXPECT_THAT(raw_client(port_).get("/nothing"), StartsWith("HTTP/1.1 404"));
  ASSERT_TRUE(gets_scans(*open_page()));
  const std::string text = raw_client(port_).get("/status.json");
  const json status = json::parse(text.substr(text.find("\r\n\r\n") + 4));
  EXPECT_EQ(status["state"], "running");
  EXPECT_TRUE(std::ranges::any_of(status["stages"],
                                  [](const json& each) { return each["stage"] == "returns"; }));
  EXPECT_EQ(end(SIGINT).code, 130);
}

TEST_F(Server, PageProtocol_FromHelloToASetting) {
  begin({"--allow-set"}, "sim:?serial=1111222233334444");
  const auto client = open_page();
  const json hello = next(*client, "hello");
  EXPECT_EQ(hello["device"]["serial"], "1111222233334444");
  EXPECT_EQ(hello["source"], "sim:?serial=1111222233334444");
  EXPECT_EQ(hello["allow_set"], true);
  EXPECT_TRUE(gets_scans(*client));
  client->send_text(R"({"op":"set","name":"frequency","value":10})");
  EXPECT_EQ(next(*client, "settings")["settings"]["frequency"], 10.0);
  client->send_text(R"({"op":"set","name":"frequency","value":100})");
  EXPECT_THAT(next(*client, "error")["message"].get<std::string>(), HasSubstr("range 5 to 12"));
  EXPECT_TRUE(gets_scans(*client)) << "it goes on";
  EXPECT_EQ(next(*open_page(), "hello")["settings"]["frequency"], 10.0);
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Server, Recording_IsPausedAndSought) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "20", "-o", path("raw.bin")}).code, 0);
  ASSERT_EQ(cli::run({"convert", path("raw.bin"), path("walk.mcap")}).code, 0);
  begin({"--loop"}, path("walk.mcap"));
  const auto client = open_page();
  const json hello = next(*client, "hello");
  EXPECT_NEAR(hello["recording"]["length_s"].get<double>(), 20.0, 1.0);
  ASSERT_TRUE(gets_scans(*client));
  client->send_text(R"({"op":"play","paused":true,"seek_s":12})");
  ASSERT_TRUE(gets_scans(*client, 1));
  json status = json::object();
  for (int i = 0; i < 60 && !(status.value("paused", false) && status["position_s"] > 11); ++i) {
    status = next(*client, "status");
  }
  EXPECT_NEAR(status["position_s"].get<double>(), 12.2, 0.5);
  client->send_text(R"({"op":"play","paused":false,"speed":4})");
  EXPECT_TRUE(gets_scans(*client, 5));
}

TEST_F(Server, RecordingThatWasCutOff_HasALength) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "20", "-o", path("raw.bin")}).code, 0);
  ASSERT_EQ(cli::run({"convert", path("raw.bin"), path("walk.mcap")}).code, 0);
  const auto whole = cli::read_file(path("walk.mcap"));
  cli::write_file(path("cut.mcap"), whole.substr(0, whole.size() / 2));
  begin({"--loop"}, path("cut.mcap"));
  const auto client = open_page();
  EXPECT_NEAR(next(*client, "hello")["recording"]["length_s"].get<double>(), 10.0, 2.0);
  client->send_text(R"({"op":"play","paused":true,"seek_s":6})");
  json status = next(*client, "status");
  while (!status.is_null() && !(status.value("position_s", 0.0) > 5.5)) {
    status = next(*client, "status");
  }
  ASSERT_FALSE(status.is_null());
  EXPECT_NEAR(status["position_s"].get<double>(), 6.2, 0.5);
}

TEST_F(Server, ForeignNamesAndOrigins_AreRefused) {
  begin({"--allow-origin", "https://app.foxglove.dev"});
  const std::string host = "Host: localhost\r\n";
  for (const std::string& more :
       {std::string("Host: evil.example\r\n"), std::string(),
        host + "Origin: http://evil.example\r\n", host + "Origin: null\r\n",
        std::string("Host: localhost.evil.example\r\n")}) {
    for (const char* protocol : {page, "foxglove.websocket.v1"}) {
      EXPECT_THAT(raw_client(port_).upgrade(protocol, more), Not(StartsWith("HTTP/1.1 101")))
          << more;
    }
  }
  for (const std::string& more : {host, host + "Origin: http://localhost\r\n",
                                  host + "Origin: https://app.foxglove.dev\r\n"}) {
    EXPECT_THAT(raw_client(port_).upgrade("foxglove.sdk.v1", more), StartsWith("HTTP/1.1 101"))
        << more;
  }
  EXPECT_THAT(raw_client(port_).get("/", "Origin: http://evil.example\r\n"),
              StartsWith("HTTP/1.1 403"));
  raw_client rebound(port_);
  rebound.send("GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n");
  EXPECT_THAT(rebound.read_to_end().value_or(""), StartsWith("HTTP/1.1 403"));
}

TEST_F(Server, UnknownSubprotocols_AreRefused) {
  begin();
  EXPECT_THAT(raw_client(port_).upgrade("chat"), Not(StartsWith("HTTP/1.1 101")));
  EXPECT_THAT(raw_client(port_).upgrade("http"), Not(StartsWith("HTTP/1.1 101")));
  EXPECT_THAT(raw_client(port_).upgrade("foxglove.sdk.v1, foxglove.websocket.v1"),
              HasSubstr("foxglove.sdk.v1\r\n"));
}

TEST_F(Server, HostileRequests_HarmNobodyElse) {
  begin();
  const auto good = open_page();
  const auto deaf = open_page();  // never reads
  // All at once: the server waits a while for the rest of a request.
  std::vector<raw_client> all;
  for (const std::string& request :
       {std::string(100'000, 'A'), "GET / HTTP/1.1\r\nX: " + std::string(100'000, 'A'),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xFC\x03\x03", 11),
        std::string("\r\n\r\n\r\n"),
        std::string("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000\r\n\r\nx"),
        std::string("GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: "
                    "Upgrade\r\n\r\n"),
        std::string("GET /%00%2e%2e/ HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
        std::string(), std::string("GET / HTTP/1.1\r\nHost: loc")}) {
    all.emplace_back(port_);
    all.back().send(request);
  }
  EXPECT_TRUE(gets_scans(*good));
  for (raw_client& bad : all) {
    const auto answer = bad.read_to_end();
    ASSERT_TRUE(answer) << "it is closed: number " << &bad - all.data();
    EXPECT_THAT(*answer, Not(StartsWith("HTTP/1.1 101")));
  }
  EXPECT_TRUE(gets_scans(*good));
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Server, DamagedHandshakesAndFrames_EndOnlyTheirConnection) {
  begin();
  const auto good = open_page();
  std::mt19937 random(11);
  const auto damage = [&random](std::string bytes) {
    for (auto left = 1 + random() % 4; left > 0; --left) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    return bytes;
  };
  int upgraded = 0;
  for (int i = 0; i < g4lidar::test::scaled(300); ++i) {
    const char* const protocol = i % 4 < 2 ? page : "foxglove.sdk.v1";
    const std::string frames =
        raw_client::frame(1, R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1}]})") +
        raw_client::frame(9, "ping") + raw_client::frame(1, R"({"op":"play","speed":2})") +
        raw_client::frame(8, "\x03\xE8");
    raw_client bad(port_);
    if (i % 2 == 0) {
      bad.send(damage(raw_client::upgrade_request(protocol)) + frames);
    } else {
      upgraded += bad.upgrade(protocol).starts_with("HTTP/1.1 101") ? 1 : 0;
      bad.send(damage(frames));
    }
  }
  EXPECT_GT(upgraded, 100);
  EXPECT_TRUE(gets_scans(*good));
  EXPECT_TRUE(gets_scans(*open_page()));
  EXPECT_EQ(end().code, 128 + SIGTERM);
}

TEST_F(Server, LostLidar_IsShownAndComesBack) {
  begin({}, "sim:?fault=unplug@2s+3s");
  const auto client = open_page();
  ASSERT_TRUE(
      g4lidar::test::comes_true([&] { return next(*client, "status")["state"] == "lost"; }));
  EXPECT_EQ(next(*client, "event")["what"], "reconnected");
  EXPECT_TRUE(gets_scans(*client));
}

TEST_F(Server, OnLossExit_EndsAsOtherCommands) {
  begin({"--on-loss", "exit"}, "sim:?fault=unplug@1500ms");
  const outcome done = running_->wait();
  EXPECT_EQ(done.code, 9) << cli::read_file(path("err"));
}

TEST_F(Server, PortInUse_IsReported) {
  begin();
  const outcome second = cli::run({"serve", "sim:", "--port", std::to_string(port_)});
  EXPECT_EQ(second.code, 5);
  EXPECT_THAT(second.err, HasSubstr("is in use by another program. Give another --port"));
  EXPECT_EQ(cli::run({"serve", "sim:", "--address", "nowhere"}).code, 2);
  EXPECT_EQ(cli::run({"serve", "sim:", "--address", "192.0.2.1", "--port", "0"}).code, 2);
}

TEST_F(Server, NoServerProgram_NamesThePackage) {
  std::filesystem::copy_file(G4_DUMP, path("g4-dump"));
  const std::string line = "PATH=/nowhere " + path("g4-dump") + " serve sim: 2> " + path("words");
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 10);
  EXPECT_THAT(cli::read_file(path("words")), HasSubstr("package g4lidar-serve"));
}

}  // namespace
