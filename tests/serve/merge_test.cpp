// SPDX-License-Identifier: MIT
// Several lidars as one scan: where their points are, their recordings, and requests to one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server.hpp"
#include "support/cdr_reader.hpp"
#include "support/patience.hpp"

namespace {

using nlohmann::json;
using serve::raw_client;
using serve::Server;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct place {
  double x;
  double y;
};

template <class Number>
Number number_at(const std::string& data, std::size_t at) {
  Number value{};
  std::memcpy(&value, data.substr(at, sizeof(value)).data(), sizeof(value));
  return value;
}

/// The room of 5 m by 2.7 m, in its frame.
constexpr const char* small_room =
    "wall -2 -1.5 3 -1.5\nwall 3 -1.5 3 1.2\nwall 3 1.2 -2 1.2\nwall -2 1.2 -2 -1.5\n";

double to_wall(const place& at) {
  return std::min(std::min(std::fabs(at.x + 2), std::fabs(at.x - 3)),
                  std::min(std::fabs(at.y + 1.5), std::fabs(at.y - 1.2)));
}

class Merged : public Server {
 protected:
  Merged() {
    // The direction of a lidar's cable is opposite to that of its mounting.
    cli::write_file(path("front.txt"), std::string(small_room) + "lidar 0.3 0.1 -160\n");
    cli::write_file(path("rear.txt"), std::string(small_room) + "lidar -0.4 -0.2 30\n");
  }
  /// Two lidars in one room: `front_more` and `rear_more` are added to the setups.
  void begin_both(const std::vector<std::string>& more = {}, const std::string& front_more = "",
                  const std::string& rear_more = "") {
    std::vector<std::string> words{"rear=sim:?world=" + path("rear.txt") + rear_more,
                                   "--merge",
                                   "--mount",
                                   "front=0.3,0.1,20",
                                   "--mount",
                                   "rear=-0.4,-0.2,-150"};
    words.insert(words.end(), more.begin(), more.end());
    begin(words, "front=sim:?world=" + path("front.txt") + front_more);
  }
  /// The next status that is as wanted.
  static json next_status(raw_client& client, const std::function<bool(const json&)>& is_wanted) {
    json status = next(client, "status");
    while (!status.is_null() && !is_wanted(status)) status = next(client, "status");
    return status;
  }
  [[nodiscard]] std::ptrdiff_t files_in(const char* directory) const {
    return std::distance(std::filesystem::directory_iterator(path(directory)), {});
  }
  static json answer_to(raw_client& client, const char* request, const char* op) {
    client.send_text(request);
    return next(client, op);
  }
};

TEST_F(Merged, PagesKnowTheLidars) {
  begin_both({"--allow-set"}, "", "&model=t-mini");
  const auto client = open_page();
  json hello = next(*client, "hello");
  while (!hello.is_null() && (hello["lidars"][0]["device"]["name"].is_null() ||
                              hello["lidars"][1]["device"]["name"].is_null())) {
    hello = next(*client, "hello");
  }
  ASSERT_EQ(hello["lidars"].size(), 2U);
  EXPECT_EQ(hello["lidars"][0]["name"], "front");
  EXPECT_EQ(hello["lidars"][0]["device"]["name"], "G4");
  EXPECT_EQ(hello["lidars"][1]["name"], "rear");
  EXPECT_EQ(hello["lidars"][1]["device"]["name"], "T-mini");
  const json status =
      next_status(*client, [](const json& now) { return now["lidars"][1]["state"] == "running"; });
  EXPECT_EQ(status["lidars"][0]["name"], "front");
  // A setting of one of them.
  const json settings =
      answer_to(*client, R"({"op":"set","lidar":"rear","name":"frequency","value":9})", "settings");
  EXPECT_EQ(settings["lidars"]["rear"]["frequency"], 9.0);
  EXPECT_NE(settings["lidars"]["front"]["frequency"], 9.0);
  for (const char* const bad : {R"({"op":"set","lidar":"left","name":"frequency","value":9})",
                                R"({"op":"set","name":"frequency","value":9})",
                                R"({"op":"set","lidar":"","name":"frequency","value":9})"}) {
    EXPECT_THAT(answer_to(*client, bad, "error")["message"].get<std::string>(),
                HasSubstr("there is no lidar"))
        << bad;
  }
  const std::string of_long_name =
      R"({"op":"set","lidar":")" + std::string(9000, 'x') + R"(","name":"frequency","value":9})";
  EXPECT_EQ(answer_to(*client, of_long_name.c_str(), "error")["of"], "set");
  // The T-mini has no direction.
  EXPECT_EQ(answer_to(*client, R"({"op":"set","lidar":"rear","name":"direction","value":"cw"})",
                      "error")["of"],
            "set");
}

TEST_F(Merged, EachLidarIsRecorded_WithinTheLimitTogether) {
  const std::string recordings = path("recordings");
  std::filesystem::create_directory(recordings);
  begin_both({"--allow-record", recordings});
  const auto client = open_page();
  next_status(*client, [](const json& now) {
    return std::ranges::all_of(now["lidars"],
                               [](const json& each) { return each["scan_rate_hz"].is_number(); });
  });
  client->send_text(R"({"op":"record","on":true})");
  const auto of_both = [](const json& now) {
    return now["recording"]["file"].is_string() &&
           now["recording"]["file"].get<std::string>().find(", ") != std::string::npos;
  };
  const json status = next_status(*client, of_both);
  const auto names = status["recording"]["file"].get<std::string>();
  EXPECT_THAT(names, ::testing::MatchesRegex("g4-[0-9TZ]+-front\\.mcap, g4-[0-9TZ]+-rear\\.mcap"));
  EXPECT_THAT(
      answer_to(*client, R"({"op":"record","on":true})", "error")["message"].get<std::string>(),
      HasSubstr("rear: "));
  ASSERT_TRUE(gets_scans(*client, 12));
  client->send_text(R"({"op":"record","on":false})");
  next_status(*client, [](const json& now) { return now["recording"]["file"].is_null(); });
  const std::size_t comma = names.find(", ");
  for (const std::string& name : {names.substr(0, comma), names.substr(comma + 2)}) {
    const auto done = cli::run({"stats", "--json", recordings + '/' + name});
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_GE(json::parse(done.out)["scans"].get<int>(), 5) << name;
  }
}

TEST_F(Merged, FoxgloveGetsThem_InTheFrameOfTheRobot) {
  if constexpr (std::endian::native != std::endian::little) GTEST_SKIP();
  begin_both();
  raw_client client(port_);
  ASSERT_THAT(client.upgrade("foxglove.sdk.v1"), StartsWith("HTTP/1.1 101"));
  client.send_text(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":2}]})");
  std::vector<std::uint8_t> cloud;
  EXPECT_TRUE(g4lidar::test::comes_true([&] {
    const auto message = client.next_frame();
    constexpr std::size_t head = 13;  // kind, subscription, time
    if (message && message->starts_with('\x01')) {
      cloud.assign(message->begin() + head, message->end());
    }
    return cloud.size() > 2000U * 24;
  }));
  g4lidar::test::cdr_reader reader(cloud);
  for (int of_stamp = 0; of_stamp < 2; ++of_stamp) static_cast<void>(reader.number<std::int32_t>());
  EXPECT_EQ(reader.text(), "base_link");
  constexpr std::size_t row = 24;  // x, y, z, t, range, angle
  const std::size_t rows = (cloud.size() - 1) / row;
  const std::string data(cloud.begin(), cloud.end() - 1);  // is_dense follows
  std::size_t seen = 0;
  for (std::size_t i = 0; i + 2 < rows && seen < 2000; ++i, ++seen) {
    const std::size_t at = data.size() - (seen + 1) * row;
    EXPECT_LT(to_wall({static_cast<double>(number_at<float>(data, at)),
                       static_cast<double>(number_at<float>(data, at + 4))}),
              0.06);
  }
  EXPECT_EQ(seen, 2000U);
}

TEST_F(Merged, NoneIsRecorded_IfOneIsNotConnected) {
  std::filesystem::create_directory(path("made"));
  begin_both({"--allow-record", path("made")}, "&fault=unplug@2s");
  const auto client = open_page();
  next_status(*client, [](const json& now) { return now["lidars"][0]["state"] == "lost"; });
  const json refused = answer_to(*client, R"({"op":"record","on":true})", "error");
  EXPECT_EQ(refused["of"], "record");
  EXPECT_EQ(refused["message"], "front: the lidar is not connected");
  next_status(*client, [](const json& now) {  // it is discarded soon
    return now["recording"]["file"].is_null() && now["recording"]["last"].is_null();
  });
  EXPECT_TRUE(g4lidar::test::comes_true([&] { return files_in("made") == 0; }));
}

TEST_F(Merged, WhatCannotBeMerged_IsAnErrorAtTheStart) {
  const auto refusal = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"serve", "--port", "0"});
    const auto done = cli::run(words);
    EXPECT_EQ(done.code, 2) << done.err;
    return done.err;
  };
  EXPECT_THAT(refusal({"front=sim:", "rear=sim:"}), HasSubstr("--merge"));
  EXPECT_THAT(refusal({"sim:", "rear=sim:", "--merge"}), HasSubstr("need names"));
  EXPECT_THAT(refusal({"a=sim:", "a=sim:", "--merge"}), HasSubstr("names two lidars"));
  EXPECT_THAT(refusal({"a=sim:", "--merge", "--mount", "b=0,0,0"}),
              HasSubstr("there is no lidar 'b'"));
  cli::write_file(path("walk.bin"), "");
  EXPECT_THAT(refusal({"a=sim:", "b=file:" + path("walk.bin"), "--merge"}), HasSubstr("clock"));
}

TEST_F(Merged, OneThatHasEnded_IsReported_AndTheOtherGoesOn) {
  begin_both({"--on-loss", "exit"}, "&fault=unplug@5s");
  const auto client = open_page();
  ASSERT_FALSE(next_status(*client, [](const json& now) {
                 return now["lidars"][0]["state"] == "ended";
               }).is_null());
  EXPECT_TRUE(g4lidar::test::comes_true([&] {
    return cli::read_file(path("err")).find("front: ") != std::string::npos;
  })) << cli::read_file(path("err"));
  EXPECT_TRUE(gets_scans(*client));
}

}  // namespace
