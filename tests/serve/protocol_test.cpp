// SPDX-License-Identifier: MIT
// The texts and messages of both protocols, and what is no request of theirs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "foxglove_protocol.hpp"
#include "page_protocol.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4_tool;
using nlohmann::json;

TEST(PageRequest, SetTakesWordsNumbersAndFlags) {
  const auto value_of_set = [](const std::string& value) {
    const auto read =
        parse_page_request(R"({"op":"set","name":"frequency","value":)" + value + "}");
    const auto* const set = read ? std::get_if<set_request>(&*read) : nullptr;
    return set == nullptr ? "refused" : set->name + '=' + set->value;
  };
  EXPECT_EQ(value_of_set("\"9k\""), "frequency=9k");
  EXPECT_EQ(value_of_set("7.5"), "frequency=7.5");
  EXPECT_EQ(value_of_set("10"), "frequency=10");
  EXPECT_EQ(value_of_set("true"), "frequency=on");
  EXPECT_EQ(value_of_set("false"), "frequency=off");
  EXPECT_EQ(value_of_set("null"), "refused");
  EXPECT_EQ(value_of_set("[1]"), "refused");
}

TEST(PageRequest, PlayTakesWhatIsGiven) {
  const auto read = parse_page_request(R"({"op":"play","paused":true,"seek_s":2.5})");
  const auto& play = std::get<play_request>(read.value());
  EXPECT_EQ(play.paused, true);
  EXPECT_EQ(play.seek_s, 2.5);
  EXPECT_EQ(play.speed, std::nullopt);
  for (const char* bad :
       {R"({"op":"play"})", R"({"op":"play","speed":"fast"})",
        R"({"op":"play","paused":true,"more":1})", R"({"op":"play","seek_s":null})"}) {
    EXPECT_TRUE(std::holds_alternative<bad_request>(parse_page_request(bad).value())) << bad;
  }
}

TEST(PageRequest, WhatNoPageSendsIsRefused) {
  const std::string deep =
      R"({"op":"set","name":)" + std::string(200, '[') + std::string(200, ']') + "}";
  const std::string text = R"({"op":"set","name":"frequency","value":7})";
  for (const std::string& bad :
       {std::string(), std::string("hello"), std::string("[]"), std::string("{}"),
        std::string(R"({"op":1})"), std::string("{\"op\":\"set\""), deep, text + "x",
        std::string("\xFF\xFE"), std::string(R"({"op":")") + std::string(20'000, 'a') + "\"}"}) {
    EXPECT_FALSE(parse_page_request(bad)) << bad.substr(0, 40);
    EXPECT_FALSE(parse_foxglove_request(bad)) << bad.substr(0, 40);
  }
  const auto other = parse_page_request(R"({"op":"dance"})");
  EXPECT_EQ(std::get<bad_request>(other.value()).of, "dance");
}

TEST(FoxgloveRequest, SubscribeAndUnsubscribe) {
  const auto read = parse_foxglove_request(
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":4294967295,"channelId":3}]})");
  const auto& all = std::get<subscribe_request>(read.value()).entries;
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].id, 4294967295U);
  EXPECT_EQ(all[1].channel_id, 3U);
  const auto rest = parse_foxglove_request(R"({"op":"unsubscribe","subscriptionIds":[7]})");
  EXPECT_EQ(std::get<unsubscribe_request>(rest.value()).ids, std::vector<std::uint32_t>{7});
  for (const char* bad :
       {R"({"op":"subscribe"})", R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1}]})",
        R"({"op":"subscribe","subscriptions":[1]})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})"}) {
    EXPECT_FALSE(parse_foxglove_request(bad)) << bad;
  }
  const auto other = parse_foxglove_request(R"({"op":"getParameters","parameterNames":[]})");
  EXPECT_EQ(std::get<other_request>(other.value()).op, "getParameters");
}

TEST(FoxgloveTexts, AreAsTheProtocolWants) {
  const json info = json::parse(server_info_text("abc"));
  EXPECT_EQ(info["op"], "serverInfo");
  EXPECT_EQ(info["sessionId"], "abc");
  EXPECT_TRUE(info["capabilities"].is_array());
  const json all = json::parse(advertise_text());
  ASSERT_EQ(all["channels"].size(), 4U);
  EXPECT_EQ(all["channels"][0]["topic"], "/scan");
  EXPECT_EQ(all["channels"][0]["schemaName"], "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(all["channels"][1]["schemaName"], "sensor_msgs/msg/PointCloud2");
  EXPECT_EQ(all["channels"][2]["schemaName"], "diagnostic_msgs/msg/DiagnosticArray");
  EXPECT_EQ(all["channels"][3]["topic"], "/g4lidar/from_device");
  EXPECT_EQ(all["channels"][3]["schemaName"], "g4lidar_msgs/msg/RecordedBytes");
  for (const json& each : all["channels"]) {
    EXPECT_EQ(each["encoding"], "cdr");
    EXPECT_EQ(each["schemaEncoding"], "ros2msg");
    const bool has_bytes = each["schemaName"] == "g4lidar_msgs/msg/RecordedBytes";
    EXPECT_NE(each["schema"].get<std::string>().find(has_bytes ? "uint8[] data"
                                                               : "std_msgs/Header header"),
              std::string::npos);
    EXPECT_TRUE(channel_of(each["id"].get<std::uint32_t>()));
  }
}

TEST(FoxgloveData, HasSubscriptionAndStampInFront) {
  const outgoing made = message_data(0x01020304, 0x1112131415161718, share("x"));
  EXPECT_FALSE(made.is_text);
  EXPECT_EQ(made.size(), 14U);
  const std::array<std::uint8_t, 13> wanted{1,    4,    3,    2,    1,    0x18, 0x17,
                                            0x16, 0x15, 0x14, 0x13, 0x12, 0x11};
  EXPECT_EQ(made.prefix, wanted);
}

TEST(PageRequests, ToOneOfSeveralLidars_NameIt) {
  const auto of = [](const char* text) { return *parse_page_request(text); };
  const auto set =
      std::get<set_request>(of(R"({"op":"set","lidar":"rear","name":"frequency","value":7})"));
  EXPECT_EQ(set.lidar, "rear");
  EXPECT_EQ(std::get<set_request>(of(R"({"op":"set","name":"frequency","value":7})")).lidar, "");
  for (const char* const bad : {R"({"op":"set","lidar":1,"name":"frequency","value":7})",
                                R"({"op":"set","lidar":null,"name":"frequency","value":7})",
                                R"({"op":"set","lidar":["rear"],"name":"frequency","value":7})"}) {
    EXPECT_EQ(std::get<bad_request>(of(bad)).of, "set") << bad;
  }
}

TEST(PageRequests, OfARecording_HaveNothingElse) {
  const auto of = [](const char* text) { return parse_page_request(text); };
  EXPECT_TRUE(std::get<record_request>(*of(R"({"op":"record","on":true})")).is_on);
  EXPECT_FALSE(std::get<record_request>(*of(R"({"op":"record","on":false})")).is_on);
  for (const char* const bad :
       {R"({"op":"record"})", R"({"op":"record","on":1})", R"({"op":"record","on":"true"})",
        R"({"op":"record","on":true,"file":"../../etc/passwd"})",
        R"({"op":"record","file":"x.mcap"})"}) {
    const auto got = of(bad);
    ASSERT_TRUE(got && std::holds_alternative<bad_request>(*got)) << bad;
    EXPECT_EQ(std::get<bad_request>(*got).of, "record");
  }
}

TEST(PageTexts, AdviceIsNotForACommandLine) {
  g4_tool::page_status status;
  status.stages.push_back({.stage = g4lidar::diagnostic_stage::stream});
  status.stages.back().find(g4lidar::diagnosis::unplugged);
  const json text = json::parse(g4_tool::status_text(status));
  const auto advice = text["stages"][0]["diagnoses"][0]["advice"].get<std::string>();
  EXPECT_THAT(advice, ::testing::HasSubstr("plug it in"));
  EXPECT_THAT(advice, ::testing::Not(::testing::HasSubstr("--")));
  EXPECT_THAT(advice, ::testing::Not(::testing::HasSubstr("command")));
}

TEST(PageTexts, SayWhatIsKnownAndNullElse) {
  const json hello = json::parse(
      hello_text({.source = "a\"b",
                  .lidars = {{.model = &g4lidar::g4_model, .settings = {{"frequency", 7.0}}}},
                  .recording_s = 2.5}));
  EXPECT_EQ(hello["op"], "hello");
  EXPECT_EQ(hello["source"], "a\"b");
  EXPECT_TRUE(hello["device"]["serial"].is_null());
  EXPECT_EQ(hello["device"]["name"], "G4");
  EXPECT_EQ(hello["settings"]["frequency"], 7.0);
  EXPECT_FALSE(hello.contains("lidars"));
  EXPECT_EQ(hello["allow_set"], false);
  EXPECT_EQ(hello["recording"]["length_s"], 2.5);
  EXPECT_EQ(hello["frame"], "robot");
  const json& rows = hello["setting_rows"];
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[0], (json{{"name", "sample_rate"},
                           {"text", "samples per second"},
                           {"unit", "Hz"},
                           {"values", {"4000", "8000", "9000"}}}));
  EXPECT_EQ(rows[1], (json{{"name", "frequency"},
                           {"text", "revolutions per second"},
                           {"unit", "Hz"},
                           {"least", 5.0},
                           {"most", 12.0},
                           {"step", 0.1}}));
  EXPECT_EQ(rows[4]["values"], (json{"off", "on"}));
  page_status status{.state = g4lidar::reader_state::lost,
                     .why = "gone",
                     .recognised = {{"model", "x4"}, {"contradictions", "It is green."}},
                     .loss = 0.25};
  status.stages.push_back({.stage = g4lidar::diagnostic_stage::loss});
  status.stages.back().find(g4lidar::diagnosis::bits_flipped);
  status.stages.back().add("lost_percent", 3.5);
  status.stages.back().remark = "10 s were measured.";
  status.counts.stream.crc_mismatches = 7;
  const json text = json::parse(status_text(status));
  EXPECT_EQ(text["state"], "lost");
  EXPECT_EQ(text["recognition"], (json{{"model", "x4"}, {"contradictions", "It is green."}}));
  EXPECT_TRUE(json::parse(status_text({}))["recognition"].is_null());
  EXPECT_EQ(text["counts"]["crc_mismatches"], 7);
  EXPECT_EQ(text["loss"], 0.25);
  EXPECT_TRUE(text["scan_rate_hz"].is_null());
  EXPECT_FALSE(text.contains("position_s"));
  const json& stage = text["stages"][0];
  EXPECT_EQ(stage["stage"], "loss");
  EXPECT_EQ(stage["verdict"], "fail");
  EXPECT_EQ(stage["remark"], "10 s were measured.");
  EXPECT_EQ(stage["diagnoses"][0]["name"], "bits_flipped");
  EXPECT_FALSE(stage["diagnoses"][0]["advice"].get<std::string>().empty());
  EXPECT_EQ(stage["evidence"][0]["value"], 3.5);
}

/// The names of the settings that a page of this model offers, and their rows.
json rows_of(const char* model) {
  return json::parse(hello_text(
      {.source = "", .lidars = {{.model = g4lidar::model_named(model)}}}))["setting_rows"];
}

TEST(PageTexts, SayHowTheSpeedIsSetWithoutCommands) {
  const auto speed_of = [](const char* model) {
    const json hello =
        json::parse(hello_text({.source = "", .lidars = {{.model = g4lidar::model_named(model)}}}));
    return hello["device"]["speed_by"].get<std::string>();
  };
  EXPECT_EQ(speed_of("x4"),
            "a voltage or PWM at its pin M_SCTR; most boards leave it at their default");
  EXPECT_EQ(speed_of("g4"), "");
}

TEST(PageTexts, OfferTheSettingsThatTheModelHas) {
  EXPECT_TRUE(json::parse(hello_text({.source = "", .lidars = {{}}}))["setting_rows"].empty())
      << "as long as it is not known";
  EXPECT_TRUE(rows_of("x2").empty()) << "it takes no commands";
  // family.md: 6 to 12 Hz, one sample rate, nothing of the motor.
  const json t_mini = rows_of("t-mini");
  ASSERT_GE(t_mini.size(), 1U);
  EXPECT_EQ(t_mini[0]["name"], "frequency");
  EXPECT_EQ(t_mini[0]["least"], 6.0);
  EXPECT_EQ(t_mini[0]["most"], 12.0);
  // family.md: 3 to 16 Hz; its sample rate is that of the device.
  const json tg15 = rows_of("tg15");
  ASSERT_GE(tg15.size(), 1U);
  EXPECT_EQ(tg15[0]["name"], "frequency");
  EXPECT_EQ(tg15[0]["least"], 3.0);
  EXPECT_EQ(tg15[0]["most"], 16.0);
  for (const json& row : tg15) EXPECT_NE(row["name"], "direction");
  // family.md: codes for 8, 16 and 18 kHz.
  EXPECT_EQ(rows_of("g6")[0]["values"], (json{"8000", "16000", "18000"}));
}

TEST(PageTexts, OfSeveralLidars_HaveEachOfThem) {
  const std::vector<page_lidar> lidars{
      {.name = "front", .model = &g4lidar::g4_model, .settings = {{"frequency", 7.0}}},
      {.name = "rear", .model = g4lidar::model_named("t-mini"), .settings = {{"frequency", 9.0}}}};
  const json hello = json::parse(hello_text({.source = "a, b", .lidars = lidars}));
  ASSERT_EQ(hello["lidars"].size(), 2U);
  EXPECT_FALSE(hello.contains("device"));
  EXPECT_EQ(hello["lidars"][1]["name"], "rear");
  EXPECT_EQ(hello["lidars"][1]["device"]["name"], "T-mini");
  EXPECT_EQ(hello["lidars"][1]["device"]["range_m"], 12.0);
  EXPECT_EQ(hello["lidars"][1]["device"]["has_intensity"], true);
  EXPECT_EQ(hello["lidars"][0]["device"]["has_intensity"], false);
  EXPECT_EQ(hello["lidars"][0]["setting_rows"].size(), 6U);
  const json settings = json::parse(settings_text(lidars));
  EXPECT_EQ(settings["lidars"]["rear"]["frequency"], 9.0);
  EXPECT_EQ(json::parse(event_text("lost", 1.0, "rear"))["lidar"], "rear");

  page_status front{.lidar = "front", .state = g4lidar::reader_state::running, .loss = 0.25};
  front.scan_rate_hz = 7.0;
  front.sample_rate_hz = 9000.0;
  front.counts.stream.packets = 3;
  front.recording = page_recording{.file = "a.mcap", .bytes = 10, .seconds = 2};
  page_status rear{.lidar = "rear", .state = g4lidar::reader_state::lost, .why = "Gone."};
  rear.counts.stream.packets = 4;
  rear.stages.push_back({.stage = g4lidar::diagnostic_stage::loss});
  rear.recording = page_recording{.last = "b.mcap", .why = "full", .bytes = 5, .seconds = 1};
  const json status = json::parse(status_text(merged_status({front, rear})));
  EXPECT_EQ(status["state"], "running") << "what works is shown";
  EXPECT_EQ(status["why"], "rear: Gone.");
  EXPECT_EQ(status["scan_rate_hz"], 7.0);
  EXPECT_EQ(status["sample_rate_hz"], 9000.0);
  EXPECT_EQ(status["loss"], 0.25);
  EXPECT_EQ(status["counts"]["packets"], 7);
  ASSERT_EQ(status["lidars"].size(), 2U);
  EXPECT_EQ(status["lidars"][1]["name"], "rear");
  EXPECT_EQ(status["lidars"][1]["state"], "lost");
  EXPECT_EQ(status["stages"][0]["lidar"], "rear");
  EXPECT_EQ(status["recording"]["file"], "a.mcap");
  EXPECT_EQ(status["recording"]["last"], "b.mcap");
  EXPECT_EQ(status["recording"]["bytes"], 15);
  EXPECT_EQ(json::parse(status_text(merged_status({rear, front})))["state"], "running");
  EXPECT_EQ(json::parse(status_text(merged_status({rear, rear})))["state"], "lost");
}

// Texts that are nearly requests: whatever they are, there is an answer, and no crash.
TEST(Requests, DamagedTexts_AreAnsweredOrRefused) {
  const std::vector<std::string> good{
      R"({"op":"set","name":"frequency","value":7.5})",
      R"({"op":"set","lidar":"rear","name":"frequency","value":7.5})",
      R"({"op":"record","on":true})",
      R"({"op":"play","paused":true,"speed":2,"seek_s":1e300})",
      R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2}]})",
      R"({"op":"unsubscribe","subscriptionIds":[0,1]})"};
  std::mt19937 random(20260101);
  for (int i = 0; i < g4lidar::test::scaled(20'000); ++i) {
    std::string text = good[random() % good.size()];
    for (unsigned times = 1 + random() % 4; times > 0 && !text.empty(); --times) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, 1 + random() % 5);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 20));
          break;
        default:
          text.insert(at, std::string(1, "{}[],:\"0e-\\"[random() % 11]));
      }
    }
    const auto page = parse_page_request(text);
    const auto foxglove = parse_foxglove_request(text);
    if (page && std::holds_alternative<play_request>(*page)) {
      const auto& play = std::get<play_request>(*page);
      EXPECT_FALSE(play.seek_s && !std::isfinite(*play.seek_s));
    }
    if (json::parse(text, nullptr, false).is_discarded()) {
      EXPECT_FALSE(page) << text;
      EXPECT_FALSE(foxglove) << text;
    }
  }
}

}  // namespace
