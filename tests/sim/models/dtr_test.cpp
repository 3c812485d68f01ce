// SPDX-License-Identifier: MIT
// The line DTR: models whose motor it drives, those that it does not matter to, and the open questions.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "family_stream.hpp"

namespace g4lidar {
namespace {

using test::byte_vector;
using test::ms;
using test::second;

/// A host with the port of a device, from time 0 on.
class opened_port : public test::host_side {
 public:
  explicit opened_port(const sim::device_options& options) : host_side(options), word_("x4") {
    device.host().open(0);
  }
  opened_port(const std::string& word, const sim::device_options& options)
      : host_side(options), word_(word) {
    device.host().open(0);
  }
  void set_dtr(bool high) { device.host().set_dtr(high, now_ns); }
  void pulse(std::int64_t low_ns) {
    set_dtr(false);
    (void)listen(low_ns);
    set_dtr(true);
  }
  std::size_t packets(std::int64_t for_ns) {
    std::size_t found = 0;
    test::for_each_packet(listen(for_ns), model_named(word_)->samples,
                          [&](packet_view, std::size_t) { ++found; });
    return found;
  }

 private:
  std::string word_;
};

sim::device_options with_start(const char* word, sim::dtr_start by) {
  sim::device_options options = test::options_of(word);
  options.dtr_starts_by = by;
  return options;
}

// What owners of an X4 saw: without an edge it answers, sends the scan header, and no packet.
TEST(SimDtr, AnX4NeedsAPulse) {
  opened_port host(test::options_of("x4"));
  EXPECT_EQ(host.ask(command::device_info).size(), 27U);
  EXPECT_EQ(test::taken_apart(host.ask(command::start, second)).bytes.size(), 7U)
      << "the header only";
  EXPECT_FALSE(host.device.motor_turns());
  host.pulse(20 * ms);
  EXPECT_EQ(host.packets(second), 0U) << "it was low for a too short time";
  host.pulse(100 * ms);
  EXPECT_GT(host.packets(2 * second), 100U);
  EXPECT_TRUE(host.device.motor_turns());
  host.set_dtr(false);
  EXPECT_FALSE(host.device.motor_turns());
  (void)host.packets(second);
  EXPECT_EQ(host.packets(second), 0U) << "the head does not turn any more";
  EXPECT_TRUE(host.device.is_scanning());
  host.pulse(100 * ms);
  EXPECT_GT(host.packets(2 * second), 100U);
}

TEST(SimDtr, ThePulseMayComeBeforeTheCommand) {
  opened_port host(test::options_of("s4"));
  host.pulse(100 * ms);
  EXPECT_EQ(host.packets(2 * second), 0U) << "it turns, but is not started";
  EXPECT_TRUE(host.device.motor_turns());
  (void)host.ask(command::start);
  EXPECT_GT(host.packets(2 * second), 100U);
}

TEST(SimDtr, WhatStartsItIsAnOption) {
  const auto turns = [](sim::dtr_start by, auto&& act) {
    opened_port host(with_start("x4", by));
    act(host);
    return host.device.motor_turns();
  };
  const auto nothing = [](opened_port&) {};
  const auto down = [](opened_port& host) { host.set_dtr(false); };
  const auto short_pulse = [](opened_port& host) { host.pulse(ms); };
  const auto pulse = [](opened_port& host) { host.pulse(100 * ms); };
  EXPECT_TRUE(turns(sim::dtr_start::level, nothing));
  EXPECT_TRUE(turns(sim::dtr_start::edge, nothing)) << "the port was opened";
  EXPECT_FALSE(turns(sim::dtr_start::pulse, nothing));
  EXPECT_TRUE(turns(sim::dtr_start::level, short_pulse));
  EXPECT_FALSE(turns(sim::dtr_start::edge, short_pulse));
  EXPECT_FALSE(turns(sim::dtr_start::pulse, short_pulse));
  for (const auto by : {sim::dtr_start::level, sim::dtr_start::edge, sim::dtr_start::pulse}) {
    EXPECT_FALSE(turns(by, down));
    EXPECT_TRUE(turns(by, pulse));
  }
}

TEST(SimDtr, OneWayModelsSendWhileItIsHigh) {
  for (const char* const word : {"x2", "x3", "s2-pro", "scl", "tx8"}) {
    for (const sim::dtr_cut cut : {sim::dtr_cut::motor, sim::dtr_cut::supply}) {
      sim::device_options options = test::options_of(word);
      options.dtr_cuts = cut;
      SCOPED_TRACE(std::string(word) + (cut == sim::dtr_cut::motor ? ", motor" : ", supply"));
      opened_port host(word, options);
      EXPECT_GT(host.packets(second), 50U) << "it turned before the port was opened";
      host.set_dtr(false);
      (void)host.listen(second);
      EXPECT_EQ(host.listen(second).size(), 0U);
      EXPECT_EQ(host.device.is_up(), cut == sim::dtr_cut::motor);
      host.set_dtr(true);
      const byte_vector again = host.listen(3 * second);
      std::size_t packets = 0;
      test::for_each_packet(again, model_named(word)->samples,
                            [&](packet_view, std::size_t) { ++packets; });
      EXPECT_GT(packets, 50U);
      const std::string text(again.begin(), again.end());
      EXPECT_EQ(text.find("\xA5\x5A\x05") != std::string::npos, cut == sim::dtr_cut::supply)
          << "with its supply it boots, and sends a scan header";
    }
  }
}

TEST(SimDtr, TheLastCloseLowersIt) {
  opened_port host("x2", test::options_of("x2"));
  host.device.host().open(0);
  host.device.host().close(0);
  EXPECT_TRUE(host.device.motor_turns()) << "another program has it open";
  host.device.host().close(0);
  EXPECT_FALSE(host.device.motor_turns());
  host.device.host().open(second);
  EXPECT_TRUE(host.device.motor_turns());
}

TEST(SimDtr, OthersDoNotCare) {
  for (const test::family_model& each : test::family_models) {
    const model& its = *model_named(each.word);
    if (its.motor == motor_kind::dtr) continue;
    SCOPED_TRACE(each.word);
    opened_port host(each.word, test::options_of(each.word));
    host.set_dtr(false);
    (void)host.listen(100 * ms);
    if (each.answers) host.send(command::start);
    EXPECT_GT(host.packets(2 * second), 50U);
  }
}

TEST(SimDtr, AConnectionWithoutTheLine) {
  opened_port host(test::options_of("x4"));
  host.device.host().ignore_dtr(0);
  (void)host.ask(command::start);
  EXPECT_GT(host.packets(2 * second), 100U);
  host.set_dtr(false);
  EXPECT_GT(host.packets(2 * second), 100U);
}

TEST(SimDtr, AReplugForgetsThePulse) {
  opened_port host(test::options_of("x4"));
  host.pulse(100 * ms);
  EXPECT_TRUE(host.device.motor_turns());
  host.device.unplug(host.now_ns);
  (void)host.listen(second);
  host.device.replug(host.now_ns);
  (void)host.listen(second);
  host.device.host().open(host.now_ns);
  EXPECT_FALSE(host.device.motor_turns());
  host.pulse(100 * ms);
  EXPECT_TRUE(host.device.motor_turns());
}

TEST(SimDtr, WithoutItsSecondPlug_AnX4AnswersAndNeverTurns) {
  sim::device_options options = test::options_of("x4");
  options.motor_has_power = false;
  opened_port host(options);
  EXPECT_EQ(host.ask(command::device_info).size(), 27U);
  EXPECT_EQ(host.ask(command::health_vendor).size(), 10U);
  host.pulse(100 * ms);
  EXPECT_EQ(host.ask(command::start, 3 * second).size(), 7U);
  EXPECT_FALSE(host.device.motor_turns());
  EXPECT_EQ(host.device.motor_mhz(host.now_ns), 0U);
}

TEST(SimModels, WhoAnswersWhileItScans) {
  for (const test::family_model& each : test::family_models) {
    if (!each.answers) continue;
    sim::device_options options = test::options_of(each.word);
    test::host_side host(options);
    (void)host.ask(command::start, second);
    host.device.clear_log();
    (void)host.ask(command::device_info);
    ASSERT_EQ(host.device.log().size(), 1U) << each.word;
    const bool is_g4 = each.word == "g4" || each.word == "g4-pro" || each.word == "g5";
    EXPECT_EQ(host.device.log().front().obeyed, is_g4) << each.word;
    options.while_scanning = sim::disturbance::between;
    test::host_side other(options);
    (void)other.ask(command::start, second);
    (void)other.ask(command::device_info);
    EXPECT_TRUE(other.device.log().back().obeyed) << each.word;
  }
}

}  // namespace
}  // namespace g4lidar
