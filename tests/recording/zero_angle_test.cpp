// SPDX-License-Identifier: MIT
// The offset of zero in recordings, in parts of them, and in raw bytes: the same angles, or a word that it is missing.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "recorded_run.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using enum lidar_event::kind;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::array words{"g1", "g2", "g2a", "g2c", "r2", "tg15", "tg30", "tg50"};

/// The angles of a device are too small by the offset; in degrees, where a reply of this number can be a frequency and
/// where it cannot, for all models.
constexpr std::array offsets_deg{-108.25, -7.0, 8.0, 10.5, 90.0, 125.0, 180.0, 290.0, 359.75};

/// Records a scan of this simulated lidar. Returns all points.
run_result live(const std::string& source, const std::string& path, const lidar_options& how = {},
                const recording_options& made = {}) {
  const auto setup = std::get<sim::setup>(sim::parse_setup(source));
  sim::device device(sim::built_in_world(), setup.device, setup.faults);
  sim::virtual_clock clock;
  recording_options options = made;
  options.model = model_named(setup.model);
  auto writer = recording_writer::create(path, options);
  EXPECT_TRUE(writer);
  run_result run;
  {
    auto from = recorded(std::make_unique<sim::virtual_connector>(device, clock), *writer);
    lidar_options used = how;
    used.model = options.model;
    auto opened = lidar::open(std::move(*from), used);
    EXPECT_TRUE(opened) << opened.error().message();
    if (!opened) return run;
    collector all(*opened);
    EXPECT_TRUE(opened->start());
    while (clock.now_ns() < 12 * second_ns) {
      const auto scan = opened->try_scan(500ms);
      EXPECT_TRUE(scan) << scan.error().message();
      if (!scan) break;
      all.points(run);
    }
    while (const auto event = opened->next_event()) run.events.push_back(event->what);
    EXPECT_TRUE(opened->close());
  }
  EXPECT_TRUE(writer->close());
  return run;
}

bool has(const run_result& run, lidar_event::kind what) {
  return std::ranges::count(run.events, what) == 1;
}

/// How many points at the end of `longer` are behind the last one of `shorter`.
std::size_t ahead_of(const std::vector<point>& longer, const std::vector<point>& shorter) {
  constexpr std::size_t compared = 200;
  for (std::size_t ahead = 0; ahead + compared < longer.size(); ++ahead) {
    const auto end = longer.rbegin() + static_cast<std::ptrdiff_t>(ahead);
    if (std::equal(end, end + compared, shorter.rbegin(),
                   [](const point& a, const point& b) { return a.range_mm == b.range_mm; })) {
      return ahead;
    }
  }
  return longer.size();
}

/// How far `got` is turned from `wanted` for the points of the same samples. One of both may end earlier.
double turned_deg(const std::vector<point>& wanted, const std::vector<point>& got) {
  if (wanted.size() < 2000 || got.size() < 2000) return 999.0;
  const std::size_t more = ahead_of(wanted, got);
  const bool is_wanted_longer = more < wanted.size();
  const std::size_t skip_wanted = is_wanted_longer ? more : 0;
  const std::size_t skip_got = is_wanted_longer ? 0 : ahead_of(got, wanted);
  if (skip_got >= got.size()) return 999.0;
  double most = 0.0;
  std::size_t compared = 0;
  for (std::size_t i = 1;
       i <= std::min<std::size_t>({wanted.size() - skip_wanted, got.size() - skip_got, 5000});
       ++i) {
    const point& a = wanted[wanted.size() - skip_wanted - i];
    const point& b = got[got.size() - skip_got - i];
    EXPECT_EQ(a.range_mm, b.range_mm) << i;
    if (a.range_mm != b.range_mm) return 999.0;
    const double apart =
        std::remainder(static_cast<double>(b.angle_deg) - static_cast<double>(a.angle_deg), 360.0);
    if (std::abs(apart) > std::abs(most)) most = apart;
    ++compared;
  }
  EXPECT_GT(compared, 1000U);
  return most;
}

/// The raw bytes of a recording from a time on.
std::string raw_of(const std::string& recording, const std::string& path,
                   std::int64_t from_ns = 0) {
  auto reader = recording_reader::open(recording);
  EXPECT_TRUE(reader);
  raw_copy copy(reader->model(), reader->device().value_or(recorded_device{}).information);
  std::vector<std::uint8_t> all;
  EXPECT_TRUE(reader->for_each([&](const recorded_item& item) {
    copy.take(item, item.time_ns - reader->first_ns() >= from_ns, all);
    return true;
  }));
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(all.data()), static_cast<std::streamsize>(all.size()));
  return path;
}

std::vector<std::uint8_t> sent_by_device(const std::string& recording) {
  std::vector<std::uint8_t> all;
  auto reader = recording_reader::open(recording);
  EXPECT_TRUE(reader->for_each([&](const recorded_item& item) {
    if (item.what == recorded_item::kind::from_device) {
      all.insert(all.end(), item.data.begin(), item.data.end());
    }
    return true;
  }));
  return all;
}

std::vector<std::uint8_t> contents_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

run_result played(const std::string& path, const lidar_options& how = {}) {
  lidar_options used = how;
  used.device = path;
  auto from = [&] {
    if (is_recording(path)) return replay::open(path);
    return open_raw_bytes(path, {}, {}, {}, how.model);
  }();
  EXPECT_TRUE(from) << from.error().message();
  return replayed(std::move(*from), true, how);
}

std::string source_of(std::string_view word, double offset_deg, std::string_view more = "") {
  return "sim:?model=" + std::string(word) +
         "&seed=3&zero_angle_cdeg=" + std::to_string(std::lround(100 * offset_deg)) +
         std::string(more);
}

class ZeroAngle : public testing::TestWithParam<const char*> {};

TEST_P(ZeroAngle, OfRawBytes_IsThatOfTheRecording) {
  for (const double offset_deg : offsets_deg) {
    SCOPED_TRACE(offset_deg);
    const temporary_path file;
    const temporary_path raw(".bin");
    const run_result wanted = live(source_of(GetParam(), offset_deg), file.text());
    EXPECT_FALSE(has(wanted, no_zero_angle));
    const run_result got = played(raw_of(file.text(), raw.text()));
    EXPECT_FALSE(has(got, no_zero_angle));
    EXPECT_LT(std::abs(turned_deg(wanted.points, got.points)), 0.01);
    const run_result part = played(raw_of(file.text(), raw.text(), 6 * second_ns));
    EXPECT_FALSE(has(part, no_zero_angle));
    EXPECT_LT(std::abs(turned_deg(wanted.points, part.points)), 0.01);
  }
}

// An offset that can only be an angle is found where the lidar has sent it: nothing is added to the bytes.
TEST_P(ZeroAngle, ThatCannotBeAFrequency_StaysAsItCame) {
  const temporary_path file;
  const temporary_path raw(".bin");
  static_cast<void>(live(source_of(GetParam(), -7.0), file.text()));
  EXPECT_EQ(contents_of(raw_of(file.text(), raw.text())), sent_by_device(file.text()));
  static_cast<void>(live(source_of(GetParam(), 180.0), file.text(), {}, {.overwrite = true}));
  // R2: in 1/100 degrees. Of the others the answer may be 7.2 Hz, and is repeated behind the scan header.
  const std::size_t more = std::string_view(GetParam()) == "r2" ? 0 : 11;
  EXPECT_EQ(contents_of(raw_of(file.text(), raw.text())).size(),
            sent_by_device(file.text()).size() + more);
}

TEST_P(ZeroAngle, OfAPart_IsThatOfTheRecording) {
  const temporary_path file;
  const run_result wanted = live(source_of(GetParam(), 90.0), file.text());
  auto from = replay::open(file.text(), {.from_ns = 6 * second_ns});
  ASSERT_TRUE(from);
  const run_result part = replayed(std::move(*from));
  EXPECT_FALSE(has(part, no_zero_angle));
  EXPECT_LT(std::abs(turned_deg(wanted.points, part.points)), 0.01);
}

TEST_P(ZeroAngle, IsInEachFileOfARecording) {
  const temporary_path file;
  const run_result wanted =
      live(source_of(GetParam(), -90.0), file.text(), {}, {.rotate_time = std::chrono::seconds(3)});
  int files = 1;
  while (is_recording(file.next(files + 1))) ++files;
  ASSERT_GT(files, 2);
  const std::string path = file.next(files);
  const run_result last = played(path);
  EXPECT_FALSE(has(last, no_zero_angle));
  EXPECT_LT(std::abs(turned_deg(wanted.points, last.points)), 0.01);
  const temporary_path raw(".bin");
  const run_result bytes = played(raw_of(path, raw.text()), {.model = model_named(GetParam())});
  EXPECT_LT(std::abs(turned_deg(wanted.points, bytes.points)), 0.01);
}

TEST_P(ZeroAngle, IsInARecordingOfRawBytes) {
  const temporary_path file;
  const temporary_path raw(".bin");
  const temporary_path again;
  const run_result wanted = live(source_of(GetParam(), 180.0), file.text());
  static_cast<void>(raw_of(file.text(), raw.text()));
  {
    auto writer = recording_writer::create(again.text());
    ASSERT_TRUE(writer);
    auto from = recorded(*open_raw_bytes(raw.text(), {}), *writer);
    ASSERT_TRUE(from);
    static_cast<void>(replayed(std::move(*from)));
    ASSERT_TRUE(writer->close());
  }
  EXPECT_LT(std::abs(turned_deg(wanted.points, played(again.text()).points)), 0.01);
  auto from = replay::open(again.text(), {.from_ns = 6 * second_ns});
  ASSERT_TRUE(from);
  const run_result part = replayed(std::move(*from));
  EXPECT_FALSE(has(part, no_zero_angle));
  EXPECT_LT(std::abs(turned_deg(wanted.points, part.points)), 0.01);
}

TEST_P(ZeroAngle, ThatIsMissing_IsReportedAndCanBeGiven) {
  const temporary_path file;
  const run_result without = live(source_of(GetParam(), 55.5, "&fault=mute=93"), file.text());
  EXPECT_TRUE(has(without, no_zero_angle));
  const run_result replay = played(file.text());
  EXPECT_TRUE(has(replay, no_zero_angle));
  expect_same_points(without.points, replay.points);
  const run_result given = played(file.text(), {.zero_angle = zero_angle{5550}});
  EXPECT_FALSE(has(given, no_zero_angle));
  EXPECT_NEAR(turned_deg(without.points, given.points), 55.5, 0.01);

  const temporary_path raw(".bin");
  static_cast<void>(raw_of(file.text(), raw.text()));
  const model* const which = model_named(GetParam());
  const run_result bytes = played(raw.text(), {.model = which});
  EXPECT_TRUE(has(bytes, no_zero_angle));
  const run_result known = played(raw.text(), {.model = which, .zero_angle = zero_angle{5550}});
  EXPECT_FALSE(has(known, no_zero_angle));
  EXPECT_NEAR(turned_deg(bytes.points, known.points), 55.5, 0.01);

  // A recording of raw bytes has what was given.
  const temporary_path again;
  {
    auto writer = recording_writer::create(again.text());
    auto from = recorded(*open_raw_bytes(raw.text(), {}, {}, {}, which), *writer);
    static_cast<void>(replayed(std::move(*from), true, {.zero_angle = zero_angle{5550}}));
    ASSERT_TRUE(writer->close());
  }
  const run_result kept = played(again.text());
  EXPECT_FALSE(has(kept, no_zero_angle));
  EXPECT_NEAR(turned_deg(bytes.points, kept.points), 55.5, 0.01);
}

TEST_P(ZeroAngle, ThatIsGiven_IsRecordedWithALidar) {
  const temporary_path file;
  const run_result wanted =
      live(source_of(GetParam(), 55.5), file.text(), {.zero_angle = zero_angle{-2000}});
  EXPECT_FALSE(has(wanted, no_zero_angle));
  const run_result again = played(file.text());
  expect_same_points(wanted.points, again.points);
  auto reader = recording_reader::open(file.text());
  ASSERT_TRUE(reader->for_each([](const recorded_item& item) {
    EXPECT_FALSE(item.what == recorded_item::kind::to_device && item.data[1] == 0x93)
        << "not asked";
    return true;
  }));
}

INSTANTIATE_TEST_SUITE_P(Models, ZeroAngle, testing::ValuesIn(words),
                         [](const auto& each) { return std::string(each.param); });

// Half millimetres, and quarters of a degree: what only the device information shows.
TEST(RawCopy, OfAPart_HasTheFirmware) {
  for (const std::string_view old : {"tg15&firmware=1.2", "r2&firmware=1.7"}) {
    const temporary_path file;
    const temporary_path raw(".bin");
    const run_result wanted = live(source_of(old, 90.0), file.text());
    const run_result part = played(raw_of(file.text(), raw.text(), 6 * second_ns));
    EXPECT_LT(std::abs(turned_deg(wanted.points, part.points)), 0.01) << old;
  }
}

TEST(RawCopy, OfAModelWithoutAnOffset_IsWhatCame) {
  for (const std::string_view word : {"g4", "x4", "t-mini-pro", "x2"}) {
    const temporary_path file;
    const temporary_path raw(".bin");
    static_cast<void>(live("sim:?model=" + std::string(word), file.text()));
    EXPECT_EQ(contents_of(raw_of(file.text(), raw.text())), sent_by_device(file.text())) << word;
    EXPECT_FALSE(raw_copy(*model_named(word)).needs_begin());
  }
}

TEST(ZeroAngleOption, OfAModelWithoutIt_IsRefused) {
  for (const model& row : models) {
    lidar_options how{.model = &row, .zero_angle = zero_angle{100}};
    const auto wrong = problem_with(how);
    EXPECT_EQ(wrong.has_value(), row.zero_angle_divisor == 0) << row.word;
    if (wrong) {
      EXPECT_EQ(wrong->code(), problem::not_supported);
    }
    how.zero_angle = zero_angle{36'001};
    EXPECT_TRUE(problem_with(how)) << row.word;
  }
}

}  // namespace
}  // namespace g4lidar::test
