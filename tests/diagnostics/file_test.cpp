// SPDX-License-Identifier: MIT
// Files of raw bytes, examined as far as bytes allow.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/recording/writer.hpp"
#include "transport/temporary_file.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

constexpr std::int64_t second = 1'000'000'000;

/// What a device sends in so many seconds that is asked who it is, and started.
std::string bytes_of(std::initializer_list<std::string_view> faults, std::int64_t seconds,
                     const sim::device_options& options = {}) {
  sim::device simulated(sim::built_in_world(), options, faults_of(faults));
  std::string all;
  std::array<std::uint8_t, 4096> buffer{};
  simulated.write(encode(command::device_info), 1);
  for (std::int64_t now = 1; now < seconds * second; now += 10'000'000) {
    if (now > second / 2 && now <= second / 2 + 10'000'000)
      simulated.write(encode(command::start), now);
    while (const std::size_t count = simulated.read(buffer, now)) {
      all.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
    }
  }
  return all;
}

examined in_file(const std::string& content, const model* which = nullptr) {
  const temporary_file file(content);
  examined done;
  done.stages = diagnose("file:" + file.path(), {.model = which});
  return done;
}

TEST(Bytes, OfAHealthyDeviceGetNoDiagnosis) {
  const examined done = in_file(bytes_of({}, 6));
  EXPECT_EQ(done.diagnoses(), "") << done;
  ASSERT_EQ(done.stages.size(), diagnostic_stage_count);
  for (const auto stage : {diagnostic_stage::permission, diagnostic_stage::holder,
                           diagnostic_stage::answers, diagnostic_stage::usb_latency}) {
    EXPECT_EQ(done.at(stage).outcome, stage_verdict::skipped) << done;
  }
  const auto& identity = done.at(diagnostic_stage::identity).measurements;
  ASSERT_EQ(identity.size(), 4U) << done;
  EXPECT_EQ(identity[3].name, "serial_number");
  EXPECT_EQ(std::get<std::string>(identity[3].value), "2021101000070073");
  EXPECT_EQ(done.at(diagnostic_stage::motor).remark,
            "The angles in the packets show a constant speed.");
  // 9000 samples a second at 7 Hz.
  const auto& rate = done.at(diagnostic_stage::rate).measurements;
  ASSERT_EQ(rate.back().name, "samples_per_revolution") << done;
  EXPECT_NEAR(std::get<double>(rate.back().value), 9000.0 / 7.0, 4.0);
}

TEST(Bytes, OfAMomentGetNoDiagnosis) {
  const std::string all = bytes_of({}, 6);
  // From a tenth of a second to a second.
  for (std::size_t count = 2000; count <= 20'000; count += 1000) {
    const examined done = in_file(all.substr(all.size() - count));
    EXPECT_EQ(done.diagnoses(), "") << count << " bytes\n" << done;
  }
}

TEST(Bytes, ShowDamage) {
  EXPECT_EQ(in_file(bytes_of({"flip"}, 6)).diagnoses(), "bits_flipped");
  EXPECT_EQ(in_file(bytes_of({"drop"}, 6)).diagnoses(), "bytes_dropped");
  EXPECT_EQ(in_file(bytes_of({"insert"}, 6)).diagnoses(), "bytes_inserted");
  EXPECT_EQ(in_file(bytes_of({"truncate"}, 6)).diagnoses(), "packets_truncated");
  EXPECT_EQ(in_file(bytes_of({"jolt"}, 6)).diagnoses(), "jolts");
}

/// `all` with something before each byte `what`.
std::string with_before(const std::string& all, char what, std::string_view added) {
  std::string made;
  for (const char each : all) {
    if (each == what) made += added;
    made += each;
  }
  return made;
}

/// As from a terminal line in its usual mode, with signals.
std::string without_line_controls(const std::string& all) {
  std::string made;
  for (const char each : all) {
    if (each == '\x03' || each == '\x11' || each == '\x13') continue;
    made += each == '\r' ? '\n' : each;
  }
  return made;
}

TEST(Bytes, ThatWereChangedOnTheWay_AreNoFaultOfTheLine) {
  struct change {
    std::string content;
    std::string_view remark;
  };
  const std::string all = bytes_of({}, 6);
  std::string hex;
  for (std::size_t i = 0; i < 4000; ++i) {
    constexpr std::string_view digits = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(all[all.size() - 4000 + i]);
    hex.append({digits[byte >> 4U], digits[byte & 15U], i % 16 == 15 ? '\n' : ' '});
  }
  for (const auto& [content, remark] :
       {change{with_before(all, '\n', "\r"), "Each 0A has a 0D before it"},
        change{"\xFF\xFB\x01\xFF\xFD\x03" + with_before(all, '\xFF', "\xFF"), "speaks telnet"},
        change{without_line_controls(all), "No 03, 0D, 11 and 13 arrived"},
        change{hex, "`xxd -r -p FILE NEW`"}}) {
    const examined done = in_file(content, &g4_model);
    EXPECT_EQ(done.diagnoses(), "changed_bytes") << done;
    std::string remarks;
    for (const stage_report& each : done.stages) remarks += each.remark;
    EXPECT_NE(remarks.find(remark), std::string::npos) << done;
    for (const stage_report& each : done.stages) {
      for (const diagnosis what : each.diagnoses) {
        EXPECT_EQ(describe(what).cause.find("reflection"), std::string_view::npos) << done;
      }
    }
  }
}

TEST(Bytes, OfAnotherMakerAreNamed) {
  std::string positions;
  for (int i = 0; i < 20; ++i)
    positions += "$GNGGA,023610.00,4004.7,N,11614.2,E,1,12,0.9,60.1,M,-9.0,M,,*58\r\n";
  const examined done = in_file(positions);
  EXPECT_EQ(done.diagnoses(), "no_lidar") << done;
  EXPECT_NE(done.at(diagnostic_stage::baud_rate).remark.find("NMEA"), std::string::npos) << done;
  EXPECT_EQ(done.at(diagnostic_stage::answers).remark,
            "There are no packets of this family of lidars.");
}

TEST(Bytes, OfAnotherRateOrModelAreFound) {
  EXPECT_EQ(in_file(bytes_of({"baud", "scanning"}, 3)).diagnoses(), "unknown_bytes");
  sim::device_options options;
  options.info.model = 4;
  EXPECT_EQ(in_file(bytes_of({}, 3, options), &g4_model).diagnoses(), "other_device");
  const examined found = in_file(bytes_of({}, 3, options));  // 4 is the number of one-way models
  EXPECT_EQ(found.diagnoses(), "") << found;
  EXPECT_EQ(found.at(diagnostic_stage::port).measurements.at(1).name, "model");
}

// A stream without device information, with so many bytes per sample: every word is counted
// in the checksum, and the first byte of three alone. (The protocol of the family.)
std::string stream_of(std::size_t sample_size, double samples_per_s, double turns_per_s,
                      std::size_t packets) {
  std::string all;
  double angle_deg = 1.0;
  const double step_deg = 360.0 * turns_per_s / samples_per_s;
  bool is_zero = true;
  std::uint32_t random = 1;
  for (std::size_t made = 0; made < packets; ++made) {
    std::size_t count = is_zero ? 1 : 0;
    double last_deg = angle_deg;
    while (!is_zero && count < 40 && angle_deg + static_cast<double>(count) * step_deg < 360.0) {
      last_deg = angle_deg + static_cast<double>(count++) * step_deg;
    }
    const auto raw_angle = [](double deg) { return static_cast<unsigned>(deg * 64.0) << 1U | 1U; };
    const unsigned type = is_zero ? static_cast<unsigned>(turns_per_s * 10.0) << 1U | 1U : 0U;
    std::vector<unsigned> words{0x55AA, type | static_cast<unsigned>(count) << 8U,
                                raw_angle(angle_deg), raw_angle(last_deg)};
    std::string body;
    unsigned checksum = words[0] ^ words[1] ^ words[2] ^ words[3];
    for (std::size_t i = 0; i < count; ++i) {
      random = random * 1664525U + 1013904223U;
      const unsigned range = 4000U + (random >> 20U);
      const unsigned bright = (random >> 8U) & 0xFFU;
      if (sample_size > 2) {
        checksum ^= bright;
        body += static_cast<char>(bright);
      }
      if (sample_size == 4) body += '\0';
      checksum ^= range;
      body += static_cast<char>(range & 0xFFU);
      body += static_cast<char>(range >> 8U);
    }
    words.push_back(checksum);
    for (const unsigned word : words) {
      all += static_cast<char>(word & 0xFFU);
      all += static_cast<char>(word >> 8U);
    }
    all += body;
    angle_deg = last_deg + step_deg;
    is_zero = angle_deg >= 360.0;
    if (is_zero) angle_deg -= 360.0;
  }
  return all;
}

TEST(Bytes, OfAnotherModelAreFoundByTheirLayout) {
  for (const std::size_t size : {3U, 4U}) {
    for (const std::size_t packets : {3U, 200U}) {
      const std::string all = stream_of(size, 4000.0, 7.0, packets);
      const examined done = in_file(all, &g4_model);
      EXPECT_EQ(done.diagnoses(), "other_device") << size << done;
      EXPECT_EQ(
          done.at(diagnostic_stage::baud_rate).remark,
          "The packets have " + std::to_string(size) + " bytes per sample; those of a G4 have 2.");
      const examined recognised = in_file(all);
      EXPECT_EQ(recognised.diagnoses(), "") << size << recognised;
      EXPECT_EQ(
          std::get<std::string>(recognised.at(diagnostic_stage::port).measurements.at(1).value),
          size == 3 ? "t-mini-pro" : "t-mini-plus-sh");
      const examined other = in_file(all, model_named(size == 3 ? "t-mini-plus-sh" : "scl"));
      EXPECT_EQ(other.diagnoses(), "other_device") << size << other;
    }
  }
  EXPECT_EQ(in_file(stream_of(2, 4000.0, 7.0, 200)).diagnoses(), "");
}

TEST(Bytes, OfAnotherModelAreFoundByTheirSpeed) {
  for (const double hz : {3000.0, 5000.0, 10'000.0, 18'000.0}) {
    const examined done = in_file(stream_of(2, hz, 7.0, 400));
    EXPECT_EQ(done.diagnoses(), "other_device") << hz << done;
    EXPECT_EQ(done.at(diagnostic_stage::rate).outcome, stage_verdict::warn);
  }
  EXPECT_EQ(in_file(stream_of(2, 18'000.0, 3.0, 800)).diagnoses(), "other_device");
  const std::string fast = stream_of(2, 16'000.0, 7.0, 400);
  EXPECT_EQ(in_file(fast, model_named("g6")).diagnoses(), "");
  const examined slow = in_file(fast, model_named("x4"));
  EXPECT_EQ(slow.diagnoses(), "other_device");
  EXPECT_EQ(slow.at(diagnostic_stage::rate).remark, "An X4 measures 5000 samples per second.");
  for (const double hz : {4000.0, 8000.0, 9000.0}) {
    EXPECT_EQ(in_file(stream_of(2, hz, 7.0, 400)).diagnoses(), "") << hz;
  }
}

TEST(Bytes, OfRealDevicesOfOtherModels) {
  const std::string family = std::string(G4LIDAR_SOURCE_DIR) + "/../shared/family/";
  if (!std::filesystem::exists(family)) {
    GTEST_SKIP() << "the packets of other models are not included: they belong to others";
  }
  for (const std::string name :
       {"tof3-tmini-synth", "tri3-i10-synth", "scl3-synth", "coin-d4-real"}) {
    std::ifstream in(family + name + ".hex");
    std::string data;
    for (std::string line; std::getline(in, line);) {
      for (std::size_t i = 0; i + 1 < line.size(); i += 2) {
        data += static_cast<char>(std::stoi(line.substr(i, 2), nullptr, 16));
      }
    }
    const examined done = in_file(data, &g4_model);
    EXPECT_EQ(done.diagnoses(), "other_device") << name << done;
    EXPECT_EQ(in_file(data).diagnoses(), "") << name;
  }
}

TEST(Bytes, OfWhichMostAreNoise) {
  const std::string good = bytes_of({}, 6);
  const auto after_noise = [&good](std::size_t percent) {
    return in_file(std::string(good.size() * percent / 100, '\x80') + good).diagnoses();
  };
  EXPECT_EQ(after_noise(90), "");
  EXPECT_EQ(after_noise(110), "line_noise");
}

TEST(Bytes, AreDiagnosedByTheirCounts) {
  stream_counts counts;
  EXPECT_EQ(diagnosis_of(counts, 0), diagnosis::bad_file);
  counts.skipped_by_reason = {300, 200, 400, 100};
  EXPECT_EQ(diagnosis_of(counts, 1000), diagnosis::unknown_bytes);
  counts.responses = 1;
  EXPECT_EQ(diagnosis_of(counts, 1020), diagnosis::unknown_bytes) << "one answer among rubbish";
  EXPECT_EQ(diagnosis_of(counts, 2000), std::nullopt) << "the lidar was not scanning";
  counts.packets = 1;
  EXPECT_EQ(diagnosis_of(counts, 1999), diagnosis::line_noise);
  EXPECT_EQ(diagnosis_of(counts, 2000), std::nullopt) << "half is not more than half";
}

TEST(Bytes, ThatAreFewOrNoneAreNoFault) {
  EXPECT_EQ(in_file("").diagnoses(), "bad_file");
  EXPECT_EQ(in_file(bytes_of({}, 1).substr(0, 400)).diagnoses(), "");
}

/// A recording of 1.5 s of a G4 that turns. Each read has the bytes of `batch_ms`, and comes `every_ms` after the one
/// before; the last one comes `last_ms` after it.
examined in_late_recording(double batch_ms, double every_ms, double last_ms,
                           const recorded_device& known) {
  const temporary_file file("");
  {
    auto writer = recording_writer::create(file.path(), {.overwrite = true});
    EXPECT_TRUE(writer);
    writer->device(known);
    sim::device simulated(sim::built_in_world(), {}, faults_of({"scanning"}));
    std::array<std::uint8_t, 4096> buffer{};
    const int reads = static_cast<int>(1'500.0 / batch_ms);
    double arrival_ms = 1'000.0;
    for (int i = 1; i <= reads; ++i) {
      std::vector<std::uint8_t> all;
      const auto now_ns = static_cast<std::int64_t>(i * batch_ms * 1e6);
      while (const std::size_t count = simulated.read(buffer, now_ns))
        all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
      arrival_ms += i == reads ? last_ms : every_ms;
      writer->from_device(all, static_cast<std::int64_t>(arrival_ms * 1e6));
    }
    EXPECT_TRUE(writer->close());
  }
  examined done;
  done.stages = diagnose("file:" + file.path(), {});
  return done;
}

// The program that recorded was late by up to 100 ms, and caught up: by the times alone the lidar is a tenth faster.
TEST(LateBytes, OfARecording_AreNoOtherRate) {
  const recorded_device seven{.frequency = scan_frequency::hz(7)};
  const examined unnamed = in_late_recording(100, 91, 91, seven);
  EXPECT_EQ(unnamed.diagnoses(), "") << unnamed;
  const examined named = in_late_recording(100, 87, 87, {.sample_rate = sample_rate::khz_9});
  EXPECT_EQ(named.diagnoses(), "") << named;
  const examined stalled = in_late_recording(100, 80, 160, seven);
  EXPECT_EQ(stalled.diagnoses(), "stalls") << stalled;
  // In small reads nothing is late: this one is faster.
  EXPECT_EQ(in_late_recording(10, 9.1, 9.1, seven).diagnoses(), "frequency_off other_device");
}

}  // namespace
