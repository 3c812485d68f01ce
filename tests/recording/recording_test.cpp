// SPDX-License-Identifier: MIT
// Written recordings are read again, intact, truncated and damaged.
#include "g4lidar/recording/writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <limits>
#include <numeric>
#include <random>

#include "made_recording.hpp"
#include "recorded_run.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

std::vector<std::uint32_t> numbers(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), first);
  return all;
}

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
  std::mt19937 dice(1);
  std::vector<std::size_t> sizes{whole.size() - 1, whole.size() - 30};
  for (int i = 0; i < 300; ++i) sizes.push_back(dice() % whole.size());
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

TEST_P(Packed, DamagedInOnePlace_LosesOneChunk) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.packed = GetParam()});
  record_readings(writer, 0, 400);
  ASSERT_TRUE(writer.close());
  const auto whole = bytes_of(path.text());
  std::mt19937 dice(2);
  for (int i = 0; i < 300; ++i) {
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
      EXPECT_TRUE(found.damage.any());
    }
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
  auto next = reader->next();
  for (; next && *next; next = reader->next()) ++items;
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error(), problem::system);
  EXPECT_EQ(next.error().system_errno(), EIO);
  EXPECT_GT(items, 1000U);
  EXPECT_FALSE(reader->damage().any());
  EXPECT_FALSE(reader->next()) << "it stays so";
}

TEST(Recording, BeginInTheMiddle_ReturnsTheStateFirst) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  recorded_event event{
      .what = recorded_event::kind::opened, .baud = 230'400, .time_ns = time_of(0)};
  event.name = "/dev/ttyUSB7";
  writer.event(event);
  event = {.what = recorded_event::kind::begun, .samples_per_second = 8000, .time_ns = time_of(1)};
  writer.event(event);
  record_readings(writer, 2, 1000);
  ASSERT_TRUE(writer.close());
  auto reader = recording_reader::open(path.text(), {.from_ns = 5 * second});
  ASSERT_TRUE(reader);
  const auto first = reader->next();
  ASSERT_TRUE(first && *first);
  ASSERT_EQ((*first)->what, recorded_item::kind::other);
  EXPECT_EQ((*first)->other.what, recorded_event::kind::state);
  EXPECT_EQ((*first)->other.samples_per_second, 8000U);
  EXPECT_EQ((*first)->other.baud, 230'400U);
  EXPECT_EQ((*first)->other.name, "/dev/ttyUSB7");
  EXPECT_TRUE((*first)->other.delivers);
}

TEST(Recording, ContainsItsDevice) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  recorded_device known;
  known.information = {
      5, 3, 2, 3, {'2', '0', '2', '1', '1', '0', '1', '0', '0', '0', '0', '7', '0', '0', '7', '3'}};
  known.ranging = ranging_frequency::khz_8;
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
    EXPECT_EQ(reader->device()->ranging, known.ranging);
    EXPECT_EQ(reader->device()->frequency, known.frequency);
    EXPECT_EQ(reader->device()->protection, known.protection);
    EXPECT_FALSE(reader->device()->idle);
    EXPECT_EQ(contents_of(*reader).readings, numbers(0, 110));
  }
}

TEST(Recording, FullFile_ContinuesInAnother) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.rotate_bytes = std::uint64_t{1} << 20U});
  constexpr std::uint32_t count = 20'000;
  record_readings(writer, 0, count);
  writer.device({});
  ASSERT_TRUE(writer.close());
  const std::uint64_t files = writer.counts().files;
  ASSERT_GE(files, 2U);
  std::vector<std::uint32_t> all;
  std::uint64_t size = 0;
  for (std::uint64_t i = 0; i < files; ++i) {
    const std::string name = i == 0 ? path.text() : path.next(static_cast<int>(i));
    SCOPED_TRACE(name);
    const contents found = contents_of_file(name);
    EXPECT_FALSE(found.damage.any());
    all.insert(all.end(), found.readings.begin(), found.readings.end());
    const auto file = bytes_of(name);
    EXPECT_LE(file.size(), std::size_t{1} << 20U);
    size += file.size();
  }
  EXPECT_EQ(all, numbers(0, count));
  EXPECT_EQ(writer.counts().file_bytes, size);
}

TEST(Recording, RotationTime_ContinuesInAnotherFile) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.rotate_time = 2s});
  writer.device({});
  record_readings(writer, 0, 1000);
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().files, 5U);
  for (int i = 1; i < 5; ++i) {
    auto reader = recording_reader::open(path.next(i));
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_TRUE(reader->device());
    payload_digest sum;
    while (const auto item = *reader->next()) {
      if (item->what == recorded_item::kind::from_device) {
        sum.add(direction::from_device, item->data);
      } else if (item->what == recorded_item::kind::to_device) {
        sum.add(direction::to_device, item->data);
      }
    }
    ASSERT_TRUE(reader->digest());
    EXPECT_EQ(reader->digest()->payload, sum.value());
  }
}

/// While this object exists, no file grows beyond this number of bytes.
class full_disk {
 public:
  explicit full_disk(rlim_t size) {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit small{size, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  full_disk(const full_disk&) = delete;
  full_disk& operator=(const full_disk&) = delete;
  ~full_disk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit limit_{};
  void (*before_)(int) = nullptr;
};

TEST(Recording, FullDisk_IsReportedOnceAndLosesOnlyThatTime) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 400);
  {
    const full_disk disk(writer.counts().file_bytes + 5000);
    record_readings(writer, 400, 400);
    const auto reported = writer.take_error();
    ASSERT_TRUE(reported);
    EXPECT_EQ(reported->code(), problem::system);
    EXPECT_EQ(reported->system_errno(), EFBIG);
    EXPECT_FALSE(writer.take_error());
  }
  record_readings(writer, 800, 200);
  EXPECT_FALSE(writer.take_error());
  ASSERT_TRUE(writer.close());
  const recording_counts counts = writer.counts();
  EXPECT_GE(counts.chunks_lost, 7U);
  EXPECT_GT(counts.bytes_lost, 0U);
  const contents found = contents_of_file(path.text());
  EXPECT_FALSE(found.damage.any());
  EXPECT_EQ(found.gaps, 1U);
  EXPECT_EQ(found.readings.front(), 0U);
  EXPECT_EQ(found.readings.back(), 999U);
  EXPECT_GE(found.readings.size(), 550U);
}

TEST(Recording, KilledProgram_LosesOnlyTheOpenChunk) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 224);
  // Nothing is closed: like after kill -9.
  const contents found = contents_of_bytes(bytes_of(path.text()));
  EXPECT_EQ(found.readings, numbers(0, 200));
  EXPECT_TRUE(found.damage.is_cut_off);
  EXPECT_EQ(found.damage.bytes_skipped, 0U);
  ASSERT_TRUE(writer.flush());
  EXPECT_EQ(contents_of_bytes(bytes_of(path.text())).readings, numbers(0, 224));
}

TEST(Recording, ExistingFile_IsReplacedOnRequestOnly) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
  }
  const auto refused = recording_writer::create(path.text());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().system_errno(), EEXIST);
  EXPECT_TRUE(recording_writer::create(path.text(), {.overwrite = true}));
}

TEST(Recording, InvalidOptions_AreRefused) {
  const temporary_path path;
  const auto refused = [&](const recording_options& how) {
    const auto made = recording_writer::create(path.text(), how);
    return !made && made.error() == problem::bad_option;
  };
  EXPECT_TRUE(refused({.rotate_bytes = 1}));
  EXPECT_TRUE(refused({.rotate_time = -1s}));
  EXPECT_TRUE(refused({.chunk_time = 1ms}));
  EXPECT_TRUE(refused({.chunk_time = 11s}));
  EXPECT_TRUE(refused({.scan_bins = 0}));
  EXPECT_TRUE(refused({.scan_bins = 65'537}));
  EXPECT_TRUE(refused({.frame_id = std::string(256, 'x')}));
  for (const std::string topic :
       {"", "scan", "/", "/scan/", "/a//b", "/1st", "/a/1st", "/a__b", "/a b", "/a-b", "~/scan",
        "/{node}", "/sc\xC3\xA4n", "/g4lidar/events", "/g4lidar/to_device"}) {
    EXPECT_TRUE(refused({.topic = topic})) << topic;
  }
  EXPECT_TRUE(refused({.topic = "/" + std::string(255, 'x')}));
  EXPECT_EQ(refused({.packed = packing::zstd}), !has_zstd());
}

TEST(Recording, Scans_AreOnTheRequestedTopic) {
  for (const std::string& topic :
       {std::string("/scan"), std::string("/front_2/_hidden/a9"), "/" + std::string(254, 'x')}) {
    const temporary_path path;
    {
      recording_writer writer = made_writer(path.text(), {.topic = topic});
      record_readings(writer, 0, 100);
      ASSERT_TRUE(writer.close());
    }
    const auto file = bytes_of(path.text());
    const std::string text(file.begin(), file.end());
    std::string wanted{static_cast<char>(topic.size()), 0, 0, 0};  // the format of MCAP texts
    wanted += topic;
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string::npos; ++at) ++found;
    EXPECT_EQ(found, 2U + 2U) << "at the front, in each of two chunks, and in the summary";
    EXPECT_EQ(contents_of_bytes(file).readings, numbers(0, 100));
  }
}

TEST(Recording, OtherFiles_AreRefused) {
  const auto what_is_wrong = [](std::string_view text) {
    const bytes data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    const auto reader = recording_access::open(std::make_shared<memory_source>(data), "it", {});
    return reader ? std::optional<problem>() : std::optional(reader.error().code());
  };
  using namespace std::string_view_literals;
  EXPECT_EQ(what_is_wrong(""), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP"), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP0\r\n"), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP0\r\n and something else that is long enough to be read"sv),
            problem::bad_file);
  const auto missing = recording_reader::open("/dev/no-recording");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().system_errno(), ENOENT);
  const auto directory = recording_reader::open("/dev");
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().code(), problem::bad_option);
  EXPECT_FALSE(is_recording("/dev/no-recording"));
}

TEST(Recording, EmptyRecording_IsValid) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
  }
  EXPECT_TRUE(is_recording(path.text()));
  EXPECT_TRUE(contents_of_file(path.text()).readings.empty());
}

TEST(Recording, ReadsOfAnySize_AreRecorded) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  std::vector<std::uint8_t> large(3'000'000);
  std::iota(large.begin(), large.end(), std::uint8_t{0});
  writer.from_device(large, begin_ns);
  ASSERT_TRUE(writer.close());
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader);
  std::vector<std::uint8_t> got;
  while (const auto item = *reader->next()) {
    EXPECT_EQ(item->time_ns, begin_ns);
    got.insert(got.end(), item->data.begin(), item->data.end());
  }
  EXPECT_EQ(got, large);
}

}  // namespace
}  // namespace g4lidar::test
