// SPDX-License-Identifier: MIT
// Written recordings are read again, intact, truncated and damaged.
#include "g4lidar/recording/writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <random>

#include "made_recording.hpp"
#include "recorded_run.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

class Packed : public testing::TestWithParam<packing> {
 protected:
  void SetUp() override {
    if (GetParam() == packing::zstd && !has_zstd()) GTEST_SKIP() << "built without zstd";
  }
};

TEST_P(Packed, ReturnsTheRecordedItems) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.packed = GetParam()});
  record_readings(writer, 0, 1000);
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().chunks, 20U);  // ten seconds
  EXPECT_EQ(writer.counts().readings, 1000U);
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader) << reader.error().message();
  EXPECT_EQ(reader->first_ns(), time_of(0));
  EXPECT_EQ(reader->last_ns(), time_of(999));
  ASSERT_TRUE(reader->digest());
  EXPECT_EQ(reader->digest()->payload, writer.digest().payload);
  const contents found = contents_of(*reader);
  EXPECT_EQ(found.readings, numbers(0, 1000));
  EXPECT_EQ(found.commands, 10U);
  EXPECT_EQ(found.gaps, 0U);
  EXPECT_FALSE(found.damage.any());
}

TEST_P(Packed, CutOffAnywhere_ReturnsTheIntactChunks) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.packed = GetParam()});
  record_readings(writer, 0, 200);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  std::size_t most = 0;
  std::vector<std::size_t> sizes{whole.size() - 1, whole.size() - 30};
  for (const int seed : test::seeds(1)) {
    std::mt19937 dice(static_cast<std::uint32_t>(seed));
    for (int i = 0; i < 300; ++i) sizes.push_back(dice() % whole.size());
  }
  std::ranges::sort(sizes);
  for (const std::size_t size : sizes) {
    const contents found = contents_of_bytes(bytes(whole).first(size));
    if (!found.is_open) continue;
    EXPECT_TRUE(found.damage.is_cut_off);
    EXPECT_EQ(found.readings, numbers(0, static_cast<std::uint32_t>(found.readings.size())));
    EXPECT_EQ(found.readings.size() % 50, 0U);  // of half a second each
    EXPECT_GE(found.readings.size(), most);     // a longer file has at least as many
    most = found.readings.size();
  }
  EXPECT_EQ(most, 200U);
}

/// Changes a bit of the file `whole`, of 400 readings.
void expect_one_chunk_lost(const std::vector<std::uint8_t>& whole, std::mt19937& dice) {
  auto file = whole;
  const std::size_t at = 8 + dice() % (file.size() - 8);
  SCOPED_TRACE(at);
  file[at] = static_cast<std::uint8_t>(file[at] ^ (1U << (dice() % 8)));
  const contents found = contents_of_bytes(file);
  ASSERT_TRUE(found.is_open);
  EXPECT_GE(found.readings.size(), 350U);
  EXPECT_TRUE(std::ranges::is_sorted(found.readings));
  const bool is_inside =
      found.readings.size() == 350 && found.readings.front() == 0 && found.readings.back() == 399;
  EXPECT_EQ(found.gaps, is_inside ? 1U : 0U);
  if (found.readings.size() < 400) {
    // A chunk whose opcode became an unknown one is no damage, but leaves a gap.
    EXPECT_TRUE(found.damage.any() || found.gaps > 0);
  }
}

TEST_P(Packed, DamagedInOnePlace_LosesOneChunk) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.packed = GetParam()});
  record_readings(writer, 0, 400);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  for (const int seed : test::seeds(1)) {
    std::mt19937 dice(static_cast<std::uint32_t>(seed));
    for (int i = 0; i < 300; ++i) expect_one_chunk_lost(whole, dice);
  }
}

/// Also of a file whose end is damaged. Nothing behind the last intact chunk counts.
TEST_P(Packed, CutOffAnywhere_EndsWithTheLastIntactChunk) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.packed = GetParam()});
  record_readings(writer, 0, 1000);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  std::mt19937 dice(3);
  for (int i = 0; i < 100; ++i) {
    auto file = whole;
    file.resize(whole.size() / 5 + dice() % (whole.size() * 4 / 5));
    if (i % 3 == 0)
      file.resize(file.size() + 1 + dice() % 5'000);  // zeros: space that was allocated
    if (i % 3 == 1) file[file.size() - 200 - dice() % 100] ^= 1U;
    const contents found = contents_of_bytes(file);
    ASSERT_FALSE(found.readings.empty());
    const auto reader =
        recording_access::open(std::make_shared<memory_source>(file), path.text(), {});
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->last_ns(), time_of(found.readings.back())) << i << ": " << file.size();
    EXPECT_EQ(reader->first_ns(), time_of(0));
  }
}

INSTANTIATE_TEST_SUITE_P(With, Packed, testing::Values(packing::none, packing::zstd),
                         [](const auto& of) {
                           return of.param == packing::none ? "None" : "Zstd";
                         });

TEST(Recording, BytesLostInTheMiddle_TheRestIsFound) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 1000);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  for (const std::size_t count : {1U, 100U, 5000U}) {
    auto file = whole;
    const auto at = file.begin() + static_cast<std::ptrdiff_t>(file.size() / 2);
    file.erase(at, at + static_cast<std::ptrdiff_t>(count));
    const contents found = contents_of_bytes(file);
    EXPECT_GE(found.readings.size(), 850U);
    EXPECT_EQ(found.readings.front(), 0U);
    EXPECT_EQ(found.readings.back(), 999U);
    EXPECT_EQ(found.gaps, 1U);
    EXPECT_GT(found.damage.bytes_skipped, 0U);
  }
}

TEST(Recording, BeginsAndEndsAtTheRequestedTimes) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 6000);
  ASSERT_TRUE(writer.close());
  auto cut_off = bytes_of(path.text());
  cut_off.resize(cut_off.size() - 100);
  for (const std::uint32_t from : {1U, 49U, 50U, 51U, 2999U, 5999U}) {
    reading_options range;
    range.from_ns = from * 10 * ms;
    EXPECT_EQ(contents_of_file(path.text(), range).readings, numbers(from, 6000 - from));
    range.to_ns = range.from_ns + 5 * 10 * ms;
    EXPECT_EQ(contents_of_file(path.text(), range).readings,
              numbers(from, std::min(5U, 6000 - from)));
    const auto source = std::make_shared<memory_source>(cut_off);
    auto reader = recording_access::open(source, "memory", range);
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_EQ(contents_of(*reader).readings, numbers(from, std::min(5U, 6000 - from)));
  }
  EXPECT_TRUE(contents_of_file(path.text(), {.from_ns = 3600 * second}).readings.empty());
}

/// A file on a disk that fails after its first bytes.
class failing_source final : public mcap::byte_source {
 public:
  failing_source(bytes data, std::uint64_t good) : data_(data.begin(), data.end()), good_(good) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return data_.size(); }

 private:
  [[nodiscard]] result<std::size_t> read_some(std::uint64_t at,
                                              std::span<std::uint8_t> out) noexcept override {
    // The summary at its end can be read.
    const bool is_good = at < good_ || at + 64 * 1024 > size();
    if (!is_good) return failure(task::reading, problem::system, "a bad disk", EIO);
    const std::size_t from = std::min(data_.size(), static_cast<std::size_t>(at));
    const std::size_t count = std::min(out.size(), data_.size() - from);
    std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(from), count, out.begin());
    return count;
  }

  std::vector<std::uint8_t> data_;
  std::uint64_t good_;
};

TEST(Recording, UnreadableFile_IsAnErrorAndNoDamage) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 20'000);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  ASSERT_GT(whole.size(), std::size_t{1} << 20U);
  auto reader = recording_access::open(
      std::make_shared<failing_source>(bytes(whole), std::uint64_t{512} << 10U), "it", {});
  ASSERT_TRUE(reader) << reader.error().message();
  std::size_t items = 0;
  const auto read = reader->for_each([&](const recorded_item&) { return ++items > 0; });
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error(), problem::system);
  EXPECT_EQ(read.error().system_errno(), EIO);
  EXPECT_GT(items, 1000U);
  EXPECT_FALSE(reader->damage().any());
  EXPECT_FALSE(reader->next()) << "it stays so";
}

TEST(Recording, ForEach_StopsWhenTakeReturnsFalse) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 10);
  ASSERT_TRUE(writer.close());
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader) << reader.error().message();
  std::vector<std::int64_t> times;
  const auto take_readings = [&](std::size_t most) {
    return reader->for_each([&times, most](const recorded_item& item) {
      if (item.what == recorded_item::kind::from_device) times.push_back(item.time_ns);
      return times.size() < most;
    });
  };
  ASSERT_TRUE(take_readings(4));
  EXPECT_EQ(times, (std::vector{time_of(0), time_of(1), time_of(2), time_of(3)}));
  ASSERT_TRUE(take_readings(1000)) << "the end is no error";
  EXPECT_EQ(times.size(), 10U);
  EXPECT_EQ(times[4], time_of(4)) << "it goes on with the next item";
}

TEST(Recording, BeginInTheMiddle_ReturnsTheStateFirst) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  recorded_event event{
      .what = recorded_event::kind::opened, .baud = 230'400, .time_ns = time_of(0)};
  event.name = "/dev/ttyUSB7";
  writer.event(event);
  event = {.what = recorded_event::kind::begun, .sample_rate_hz = 8000, .time_ns = time_of(1)};
  writer.event(event);
  record_readings(writer, 2, 1000);
  ASSERT_TRUE(writer.close());
  auto reader = recording_reader::open(path.text(), {.from_ns = 5 * second});
  ASSERT_TRUE(reader);
  const auto first = reader->next();
  ASSERT_TRUE(first && *first);
  ASSERT_EQ((*first)->what, recorded_item::kind::other);
  EXPECT_EQ((*first)->other.what, recorded_event::kind::state);
  EXPECT_EQ((*first)->other.sample_rate_hz, 8000U);
  EXPECT_EQ((*first)->other.baud, 230'400U);
  EXPECT_EQ((*first)->other.name, "/dev/ttyUSB7");
  EXPECT_TRUE((*first)->other.delivers);
}

/// The state that each chunk repeats has the whole name, as the event of the opening has.
TEST(Recording, BeginInTheMiddle_KeepsALongName) {
  const std::string by_id = "/dev/serial/by-id/";
  for (const std::size_t size : {65U, 200U, 255U, 300U}) {
    const temporary_path path;
    auto writer = made_writer(path.text());
    recorded_event event{.what = recorded_event::kind::opened, .time_ns = time_of(0)};
    const std::string name = by_id + std::string(size - by_id.size(), 'x');
    event.name = name;
    writer.event(event);
    record_readings(writer, 1, 1000);
    ASSERT_TRUE(writer.close());
    for (const std::int64_t from_ns : {std::int64_t{0}, 5 * second}) {
      auto reader = recording_reader::open(path.text(), {.from_ns = from_ns});
      ASSERT_TRUE(reader);
      const auto first = reader->next();
      ASSERT_TRUE(first && *first);
      ASSERT_EQ((*first)->what, recorded_item::kind::other);
      EXPECT_EQ((*first)->other.name, name.substr(0, 255)) << from_ns;
    }
  }
}

TEST(Recording, ContainsItsDevice) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  recorded_device known;
  known.information = {
      5, 3, 2, 3, {'2', '0', '2', '1', '1', '0', '1', '0', '0', '0', '0', '7', '0', '0', '7', '3'}};
  known.sample_rate = sample_rate::khz_8;
  known.frequency = scan_frequency{1000};
  known.protection = power_down_protection::on;
  record_readings(writer, 0, 10);
  writer.device(known);
  record_readings(writer, 10, 100);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  for (const std::size_t size : {whole.size(), whole.size() - 50}) {
    const auto source = std::make_shared<memory_source>(bytes(whole).first(size));
    auto reader = recording_access::open(source, "memory", {});
    ASSERT_TRUE(reader) << reader.error().message();
    ASSERT_TRUE(reader->device());
    EXPECT_EQ(reader->device()->information, known.information);
    EXPECT_EQ(reader->device()->sample_rate, known.sample_rate);
    EXPECT_EQ(reader->device()->frequency, known.frequency);
    EXPECT_EQ(reader->device()->protection, known.protection);
    EXPECT_FALSE(reader->device()->idle);
    EXPECT_EQ(contents_of(*reader).readings, numbers(0, 110));
  }
}

}  // namespace
}  // namespace g4lidar::test
