// SPDX-License-Identifier: MIT
// The doctor with the simulated lidar of each model: healthy ones, and each fault of this kind of lidar.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/transport/transport.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

sim::device_options device_of(std::string_view word) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word)) << word;
  return options;
}

/// At a port of which nothing is known but, perhaps, the model.
examined examine_as(const sim::device_options& options, std::string_view named,
                    std::uint32_t baud = 0, const std::vector<std::string_view>& faults = {}) {
  diagnostic_options how;
  how.model = named.empty() ? nullptr : model_named(named);
  how.baud = baud;
  const std::vector<sim::fault> all = faults_of(faults);
  sim::device simulated(sim::built_in_world(), options, all);
  sim::virtual_clock clock;
  std::unique_ptr<transport> port = std::make_unique<sim::virtual_port>(simulated, clock);
  // As a program opens it that knows nothing.
  EXPECT_TRUE(port->set_baud(230'400).value_or(false));
  examined done;
  done.stages = diagnose(std::move(port), how);
  done.seconds = static_cast<double>(clock.now_ns()) / 1e9;
  static_cast<void>(simulated.is_plugged(clock.now_ns() + 10'000'000));
  done.motor_turns = simulated.motor_turns();
  done.settings = simulated.settings();
  return done;
}

std::string fact(const examined& done, diagnostic_stage where, std::string_view name) {
  for (const evidence& each : done.at(where).measurements) {
    if (each.name == name) return each.text();
  }
  return "none";
}

std::string name_of_case(std::string_view word) {
  std::string name(word);
  std::ranges::replace(name, '-', '_');
  return name;
}

class DoctorOf : public ::testing::TestWithParam<std::string_view> {};

/// Whether a revolution has the packet whose CT byte states the number: the eighth, the zero packet included.
bool states_its_identity(const sim::device_options& options) {
  const sim::scanner_options& scanner = options.scanner;
  const double samples = 100.0 * to_hz(scanner.sample_rate) / scanner.scan_frequency_chz;
  return options.ct_information && samples / scanner.format.max_samples > 7.0;
}

/// Which stages are left out: those that need answers, and what CT bytes do not state.
void expect_stages(const examined& done, const sim::device_options& options) {
  for (const stage_report& each : done.stages) {
    const bool needs_answers = each.stage == diagnostic_stage::answers;
    const bool is_stated =
        each.stage == diagnostic_stage::identity || each.stage == diagnostic_stage::health;
    const bool is_left_out =
        options.one_way && (needs_answers || (is_stated && !states_its_identity(options)));
    EXPECT_EQ(each.outcome, is_left_out ? stage_verdict::skipped : stage_verdict::ok)
        << name_of(each.stage) << done;
  }
}

TEST_P(DoctorOf, AHealthyOne_ThatIsNamed) {
  for (const int seed : test::seeds(2)) {
    sim::device_options options = device_of(GetParam());
    options.scanner.seed = static_cast<std::uint64_t>(seed);
    const examined done = examine_as(options, GetParam());
    ASSERT_EQ(done.diagnoses(), "") << seed << done;
    expect_stages(done, options);
    EXPECT_EQ(fact(done, diagnostic_stage::baud_rate, "model"), GetParam());
    EXPECT_EQ(fact(done, diagnostic_stage::baud_rate, "baud"), std::to_string(options.baud));
    EXPECT_EQ(fact(done, diagnostic_stage::stream, "bytes_per_sample"),
              std::to_string(options.scanner.format.code.size()));
    EXPECT_EQ(done.motor_turns, options.driven_by == sim::drive::power) << done;
    EXPECT_LT(done.seconds, 10.0) << done;
    EXPECT_EQ(done.settings.scan_frequency_chz, options.scanner.scan_frequency_chz);
    EXPECT_EQ(done.settings.sample_rate, options.scanner.sample_rate);
  }
}

TEST_P(DoctorOf, AHealthyOne_IsRecognised) {
  const sim::device_options options = device_of(GetParam());
  const examined done = examine_as(options, "");
  ASSERT_EQ(done.diagnoses(), "") << done;
  expect_stages(done, options);
  const std::string found = fact(done, diagnostic_stage::baud_rate, "model");
  const std::string others = fact(done, diagnostic_stage::baud_rate, "same_bytes");
  EXPECT_TRUE(found == GetParam() || others.find(GetParam()) != std::string::npos) << done;
  EXPECT_EQ(fact(done, diagnostic_stage::baud_rate, "baud"), std::to_string(options.baud)) << done;
  EXPECT_LT(done.seconds, 15.0) << done;
  if (!options.one_way) {
    EXPECT_EQ(found, GetParam()) << done;
  }
}

// With all that measures: what is found must be what the simulated lidar does.
TEST_P(DoctorOf, AHealthyOne_ItsMeasurementsAreTrue) {
  const sim::device_options options = device_of(GetParam());
  const examined done = examine_as(options, GetParam());
  const double true_hz = options.scanner.scan_frequency_chz / 100.0;
  EXPECT_NEAR(std::stod(fact(done, diagnostic_stage::rate, "measured_hz")), true_hz, 0.01 * true_hz)
      << done;
  const double true_rate_hz = to_hz(options.scanner.sample_rate);
  EXPECT_NEAR(std::stod(fact(done, diagnostic_stage::rate, "sample_rate_hz")), true_rate_hz,
              0.02 * true_rate_hz)
      << done;
}

TEST_P(DoctorOf, ADamagedConnection) {
  const std::array<std::pair<std::string_view, std::string_view>, 5> kinds{
      {{"flip", "bits_flipped"},
       {"drop", "bytes_dropped"},
       {"insert", "bytes_inserted"},
       {"truncate*0.05", "packets_truncated"},
       {"omit*0.03", "packets_lost"}}};
  for (const auto& [fault, expected] : kinds) {
    const examined done = examine_as(device_of(GetParam()), GetParam(), 0, {fault});
    EXPECT_EQ(done.diagnoses(), expected) << fault << done;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DoctorOf, ::testing::ValuesIn(sim::model_words()),
                         [](const auto& one) { return name_of_case(one.param); });

// ---- what is wrong with the model or the rate that was named ----

/// A device, what its user has named, and the expected diagnosis.
struct belief {
  std::string_view name;
  std::string_view device;
  std::string_view named;
  std::uint32_t baud;
  std::string_view diagnoses;
  std::vector<std::string_view> words;  ///< In the remarks.
  std::vector<std::string_view> faults = {};
};

void PrintTo(const belief& one, std::ostream* out) { *out << one.name; }

std::string remarks(const examined& done) {
  std::string all;
  for (const stage_report& each : done.stages) all += each.remark + "\n";
  return all;
}

class Belief : public ::testing::TestWithParam<belief> {};

TEST_P(Belief, IsCorrected) {
  const belief& one = GetParam();
  const sim::device_options options = device_of(one.device);
  const examined done = examine_as(options, one.named, one.baud, one.faults);
  EXPECT_EQ(done.diagnoses(), one.diagnoses) << done;
  for (const std::string_view word : one.words) {
    EXPECT_NE(remarks(done).find(word), std::string::npos) << word << done;
  }
  EXPECT_EQ(done.motor_turns, options.driven_by == sim::drive::power) << done;
  EXPECT_EQ(done.stages.size(), diagnostic_stage_count - 3) << done;
}

const std::vector<belief> beliefs{
    {"X4_at115200", "x4", "x4", 115'200, "wrong_baud_rate", {"right at 128000 baud", "an X4"}},
    {"X4_unnamed_at230400", "x4", "", 230'400, "wrong_baud_rate", {"right at 128000 baud"}},
    {"X4Pro_at115200", "x4-pro", "x4-pro", 115'200, "wrong_baud_rate", {"right at 128000 baud"}},
    {"X2_at230400", "x2", "x2", 230'400, "wrong_baud_rate", {"right at 115200 baud", "an X2"}},
    {"TG30_at230400", "tg30", "tg30", 230'400, "wrong_baud_rate", {"right at 512000 baud"}},
    {"S4B_at115200", "s4b", "", 115'200, "wrong_baud_rate", {"right at 153600 baud", "an S4B"}},
    {"G4_at115200", "g4", "g4", 115'200, "wrong_baud_rate", {"right at 230400 baud", "a G4"}},
    {"TMini_scanning_at115200",
     "t-mini-pro",
     "t-mini-pro",
     115'200,
     "wrong_baud_rate",
     {"right at 230400 baud"},
     {"scanning"}},
    {"X4_isNoG4", "x4", "g4", 0, "other_device", {"an X4 at 128000 baud", "not a G4"}},
    {"G4_isNoX4", "g4", "x4", 0, "other_device", {"a G4 at 230400 baud", "not an X4"}},
    {"G2_isNoG4", "g2", "g4", 0, "other_number other_device", {"have 3 bytes"}},
    {"TG15_isNoTG30", "tg15", "tg30", 0, "other_device", {"100 is that of a TG15", "TG30 is 101"}},
    {"G4_isNoX2", "g4", "x2", 0, "other_device", {"a G4 at 230400 baud", "not an X2"}},
    {"X4_isNoX4Pro", "x4", "x4-pro", 0, "other_device", {"an X4", "not an X4 Pro"}},
    {"S2WithIntensity_isNoX2", "s2-intensity", "x2", 0, "other_device", {"not an X2"}},
    {"X4Pro_isNoX4", "x4-pro", "x4", 0, "one_way_lidar", {"answers nothing", "x4-pro"}},
    {"X4Pro_isNoG4", "x4-pro", "g4", 0, "one_way_lidar", {"answers nothing", "x4-pro"}},
    {"X2_isNoX4", "x2", "x4", 0, "one_way_lidar", {"answers nothing", "x2, x2l"}},
    {"S2_isNoS4", "s2-pro", "s4", 0, "one_way_lidar", {"answers nothing", "s2-pro"}},
    {"Scl_isNoTMini", "scl", "t-mini", 0, "one_way_lidar", {"answers nothing", "scl"}},
};

INSTANTIATE_TEST_SUITE_P(All, Belief, ::testing::ValuesIn(beliefs),
                         [](const auto& one) { return std::string(one.param.name); });

/// A bridge that makes another rate than the one that was set.
class bridge_with_few_rates final : public forwarding_transport {
 public:
  bridge_with_few_rates(std::unique_ptr<transport> inner, std::uint32_t wanted, std::uint32_t made)
      : forwarding_transport(std::move(inner)), wanted_(wanted), made_(made) {}
  [[nodiscard]] std::uint32_t baud() const noexcept override {
    const std::uint32_t set = inner().baud();
    return set == wanted_ ? made_ : set;
  }

 private:
  std::uint32_t wanted_;
  std::uint32_t made_;
};

// A CP2102 makes 500000 of 512000, and bytes arrive. (family.md, section 5)
TEST(Bridge, MakesAnotherRate_IsARemark) {
  const std::vector<std::pair<std::uint32_t, std::string>> bridges{
      {500'000, "The port runs at 500000 baud instead of 512000."}, {510'638, ""}};
  for (const auto& [made, remark] : bridges) {
    for (const char* const named : {"tg30", ""}) {
      sim::device simulated(sim::built_in_world(), device_of("tg30"));
      sim::virtual_clock clock;
      diagnostic_options how;
      how.model = model_named(named);
      auto port = std::make_unique<sim::virtual_port>(simulated, clock);
      EXPECT_TRUE(port->set_baud(230'400).value_or(false));
      examined done;
      done.stages =
          diagnose(std::make_unique<bridge_with_few_rates>(std::move(port), 512'000, made), how);
      EXPECT_EQ(done.diagnoses(), "") << done;
      EXPECT_EQ(done.at(diagnostic_stage::baud_rate).remark, remark) << done;
      EXPECT_EQ(fact(done, diagnostic_stage::baud_rate, "baud"), std::to_string(made)) << done;
    }
  }
}

// 64 bytes, a packet of USB, take 5.6 ms at 115200 baud.
TEST(Bridge, FillsItsPackets_IsNoDelay) {
  sim::device_options options = device_of("x2");
  options.batch_min_ns = options.batch_max_ns = 5'500'000;
  EXPECT_EQ(examine_as(options, "x2").diagnoses(), "");
  EXPECT_EQ(examine_as(device_of("x2"), "x2", 0, {"batch=24ms"}).diagnoses(), "usb_latency");
}

// ---- the motor of an X4 ----

TEST(MotorOfAnX4, WithoutItsSecondPlug) {
  for (const std::string_view word : {"x4", "s4", "s4b"}) {
    for (const std::string_view named : {word, std::string_view()}) {
      sim::device_options options = device_of(word);
      options.motor_has_power = false;
      const examined done = examine_as(options, named);
      EXPECT_EQ(done.diagnoses(), "no_motor_power") << word << done;
      EXPECT_EQ(done.at(diagnostic_stage::motor).outcome, stage_verdict::fail) << done;
      EXPECT_EQ(done.at(diagnostic_stage::answers).outcome, stage_verdict::ok) << done;
    }
  }
  const diagnosis_info& about = describe(diagnosis::no_motor_power);
  EXPECT_NE(about.cause.find("second plug"), std::string_view::npos);
  EXPECT_NE(about.advice.find("Connect the second plug"), std::string_view::npos);
}

TEST(MotorOfAnX4, StartsByEachKindOfLine) {
  for (const auto way : {sim::dtr_start::level, sim::dtr_start::edge, sim::dtr_start::pulse}) {
    sim::device_options options = device_of("x4");
    options.dtr_starts_by = way;
    EXPECT_EQ(examine_as(options, "x4").diagnoses(), "");
  }
}

// Bits that are flags are no fault, whatever they are.
TEST(LowerBits, AreNoFault) {
  for (const std::string_view word : {"x4", "x4-pro", "t-mini-pro", "g4"}) {
    sim::device_options options = device_of(word);
    for (std::uint8_t flags = 0; flags < 4; ++flags) {
      options.scanner.format.usual_flags = flags;
      EXPECT_EQ(examine_as(options, word).diagnoses(), "") << word << int{flags};
    }
  }
}

// ---- what a lidar without answers states in its packets ----

TEST(OneWay, ItsHealthIsThatOfItsCtBytes) {
  sim::device_options options = device_of("x4-pro");
  options.condition = {health_status::error, 16};  // the laser
  const examined done = examine_as(options, "x4-pro");
  EXPECT_EQ(done.diagnoses(), "health_error") << done;
  EXPECT_EQ(fact(done, diagnostic_stage::health, "error_code"), "16") << done;
}

TEST(OneWay, ItsIdentityIsThatOfItsCtBytes) {
  const sim::device_options options = device_of("x4-pro");
  const examined done = examine_as(options, "");
  const std::string serial(options.info.serial_digits.begin(), options.info.serial_digits.end());
  EXPECT_EQ(fact(done, diagnostic_stage::identity, "serial_number"), serial) << done;
  EXPECT_GT(std::stoi(fact(done, diagnostic_stage::loss, "crc_matches")), 20) << done;
  EXPECT_EQ(fact(done, diagnostic_stage::loss, "crc_mismatches"), "none") << done;
}

// The number of an S2 is 4, that of an SCL 22; CT bytes have the lower four bits. (family.md, section 3.4)
TEST(OneWay, AnotherNumberInItsCtBytes) {
  sim::device_options options = device_of("s2-intensity");
  options.scanner.scan_frequency_chz = 500;  // a revolution has 15 packets
  EXPECT_EQ(examine_as(options, "s2-intensity").diagnoses(), "");
  const examined done = examine_as(options, "scl");
  EXPECT_EQ(done.diagnoses(), "other_number") << done;
  EXPECT_NE(remarks(done).find("that of an SCL is 22"), std::string::npos) << done;
}

TEST(OneWay, WithoutTheCrcByteOfItsModel_IsARemark) {
  sim::device_options options = device_of("x4-pro");
  options.ct_crc = options.ct_information = false;
  options.stray_before_zero = false;
  const examined done = examine_as(options, "x4-pro");
  EXPECT_EQ(done.diagnoses(), "") << done;
  EXPECT_NE(done.at(diagnostic_stage::loss).remark.find("CRC"), std::string::npos) << done;
}

TEST(OneWay, WithoutPower_IsSilent) {
  sim::device_options options = device_of("x2");
  options.motor_has_power = false;
  EXPECT_EQ(examine_as(options, "x2").diagnoses(), "silent");
}

}  // namespace

std::string g4lidar::test::diagnoses_of_beliefs() {
  std::string all = "no_motor_power no_returns no_zero_angle other_number ";  // tests of their own
  for (const belief& one : beliefs) all.append(one.diagnoses).append(" ");
  return all;
}
