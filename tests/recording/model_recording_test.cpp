// SPDX-License-Identifier: MIT
// Recordings state the model of their lidar, and are replayed as such.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/transport/source.hpp"
#include "made_recording.hpp"
#include "support/family_reference.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Packets of ten samples of a T-mini, after a zero packet with one, and their points.
reference::family_revolutions t_mini_revolutions(unsigned count) {
  return reference::revolutions_of(reference::wire_format_of("t-mini"), count, 10, 1,
                                   [](unsigned turn, unsigned packet, unsigned i) {
                                     return reference::wire_sample{
                                         (turn + 7 * packet + i) % 256,
                                         4 * (500 + 10 * packet + i) + i % 4};
                                   });
}

void expect_points(const std::vector<point>& found,
                   const std::vector<reference::family_point>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_EQ(static_cast<double>(found[i].range_mm), wanted[i].range_mm) << i;
    ASSERT_EQ(found[i].intensity, wanted[i].intensity) << i;
    ASSERT_EQ(found[i].sample_flags, wanted[i].flags) << i;
    ASSERT_LT(reference::apart_deg(static_cast<double>(found[i].angle_deg), wanted[i].angle_deg),
              0.001)
        << i;
  }
}

class ModelRecording : public ::testing::Test {
 protected:
  ModelRecording() { std::filesystem::create_directory(directory_); }
  ~ModelRecording() override { std::filesystem::remove_all(directory_); }
  [[nodiscard]] std::string path(const std::string& name) const { return directory_ / name; }

  /// A file with the bytes of the stream, in reads of 300 bytes.
  std::string recorded_as(const model* which, const std::string& name = "made.mcap") {
    recording_writer writer = made_writer(path(name), {.model = which});
    std::int64_t time_ns = begin_ns;
    for (bytes rest = stream_.data; !rest.empty(); time_ns += ms) {
      const bytes piece = rest.first(std::min<std::size_t>(rest.size(), 300));
      writer.from_device(piece, time_ns);
      rest = rest.subspan(piece.size());
    }
    EXPECT_TRUE(writer.close());
    return path(name);
  }
  std::string raw_file() {
    std::ofstream(path("raw.bin"), std::ios::binary)
        .write(reinterpret_cast<const char*>(stream_.data.data()),
               static_cast<std::streamsize>(stream_.data.size()));
    return path("raw.bin");
  }
  static std::vector<point> played(result<lidar> device) {
    std::vector<point> all;
    if (!device) {
      ADD_FAILURE() << device.error().message();
      return all;
    }
    EXPECT_TRUE(device->start());
    while (const auto some = device->next_points(std::chrono::seconds(1))) {
      all.insert(all.end(), some->begin(), some->end());
    }
    return all;
  }
  static std::string text_of(const std::string& path) {
    const auto all = bytes_of(path);
    return {all.begin(), all.end()};
  }

  const reference::family_revolutions stream_ = t_mini_revolutions(4);
  const model* const t_mini_ = model_named("t-mini-pro");
  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("g4lidar-model-" + std::to_string(::getpid()));
};

TEST_F(ModelRecording, IsReplayedAsThisModel) {
  const std::string file = recorded_as(t_mini_);
  const auto reader = recording_reader::open(file);
  ASSERT_TRUE(reader) << reader.error().message();
  EXPECT_EQ(reader->model().word, "t-mini-pro");
  expect_points(played(lidar::open(file)), stream_.points);
  expect_points(played(lidar::open(file, {.model = t_mini_})), stream_.points);
}

// They look for these names of channels, and find no other ones.
TEST_F(ModelRecording, OlderReadersFindNoChannelOfALidar) {
  const std::string other = text_of(recorded_as(t_mini_));
  EXPECT_THAT(other, HasSubstr("/g4lidar/v2/from_device"));
  for (const char* const name : {"/g4lidar/from_device", "/g4lidar/to_device", "/g4lidar/events"}) {
    EXPECT_THAT(other, Not(HasSubstr(name)));
  }
  const std::string named = text_of(recorded_as(&g4_model, "g4.mcap"));
  EXPECT_THAT(named, HasSubstr("/g4lidar/from_device"));
  EXPECT_EQ(named, text_of(recorded_as(nullptr, "usual.mcap")));
  EXPECT_THAT(named, Not(HasSubstr("/g4lidar/v2/")));
  EXPECT_EQ(recording_reader::open(path("g4.mcap"))->model().word, "g4");
}

TEST_F(ModelRecording, AnUnknownModelIsRefusedByName) {
  model later = *t_mini_;
  later.word = "z9";
  const auto reader = recording_reader::open(recorded_as(&later));
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error(), problem::bad_file);
  EXPECT_EQ(reader.error().detail(), error_detail::unknown_model);
  EXPECT_THAT(reader.error().message(), HasSubstr("of the model z9"));
  EXPECT_THAT(reader.error().message(), HasSubstr(path("made.mcap")));
  EXPECT_EQ(lidar::open(path("made.mcap")).error(), problem::bad_file);
}

/// The chunks of the second recording behind those of the first one.
std::string joined_files(const std::string& first, const std::string& second) {
  constexpr std::size_t magic_size = 8;
  const std::size_t header_size = magic_size + 9 + 4 + 4 + 4;  // at least
  EXPECT_GT(second.size(), header_size);
  // Without the end of the first file: its last chunk is followed by the records of the second one.
  const std::size_t data_end = first.rfind(std::string("\x0F\x04\0\0\0\0\0\0\0", 9));
  return first.substr(0, data_end) + second.substr(magic_size);
}

TEST_F(ModelRecording, PartsOfDifferentModelsAreRefusedByName) {
  const std::string t_mini = text_of(recorded_as(t_mini_));
  const std::string tg15 = text_of(recorded_as(model_named("tg15"), "tg15.mcap"));
  const std::string g4 = text_of(recorded_as(nullptr, "g4.mcap"));
  struct pair {
    const std::string& first;
    const std::string& second;
    const char* words;
  };
  for (const auto& [first, second, words] : {pair{t_mini, tg15, "t-mini-pro and tg15"},
                                             {tg15, t_mini, "tg15 and t-mini-pro"},
                                             {g4, t_mini, "g4 and t-mini-pro"},
                                             {t_mini, g4, "t-mini-pro and g4"}}) {
    std::ofstream(path("joined.mcap"), std::ios::binary) << joined_files(first, second);
    auto reader = recording_reader::open(path("joined.mcap"));
    std::optional<error> why;
    if (!reader) why = reader.error();
    while (!why) {
      const auto item = reader->next();
      if (!item) why = item.error();
      ASSERT_TRUE(!item || *item) << words << ": the end";
    }
    EXPECT_EQ(*why, problem::bad_file);
    EXPECT_EQ(why->detail(), error_detail::several_models);
    EXPECT_THAT(why->message(), HasSubstr("joined.mcap, " + std::string(words)));
  }
}

TEST_F(ModelRecording, AnotherModelThanTheRecordedOneIsRefused) {
  const auto refused = lidar::open(recorded_as(t_mini_), {.model = model_named("x4")});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::other_device);
  EXPECT_EQ(refused.error().detail(), error_detail::other_samples);
  EXPECT_THAT(refused.error().message(), HasSubstr("model: x4, and the source states t-mini-pro"));
  EXPECT_EQ(lidar::open(path("made.mcap"), {.model = &g4_model}).error(), problem::other_device);
}

/// The bytes do not name their model, so the user may, later too. Its samples must have this size.
TEST_F(ModelRecording, AGuessedModelStaysAGuess) {
  const std::string file = path("guessed.mcap");
  recording_writer writer = made_writer(file);
  {
    auto from = recorded(*open_raw_bytes(raw_file(), {}, {}, {}, nullptr), writer);
    ASSERT_TRUE(from) << from.error().message();
    EXPECT_EQ((*from)->traits().recognised.by, known_by::samples);
    static_cast<void>(played(lidar::open(std::move(*from))));
  }
  ASSERT_TRUE(writer.close());
  const auto unnamed = lidar::open(file);
  ASSERT_TRUE(unnamed);
  const recognition found = unnamed->recognition();
  EXPECT_EQ(found.by, known_by::samples);
  EXPECT_EQ(found.model, t_mini_);
  EXPECT_GE(found.candidates.size(), 2U);
  EXPECT_EQ(found.candidates.front(), t_mini_);
  EXPECT_THAT(found.candidates, testing::Contains(model_named("t-mini-plus")));
  for (const std::string& suffix : {std::string(), std::string("?model=t-mini-plus")}) {
    const bool is_in_name = !suffix.empty();
    const model* const named = model_named("t-mini-plus");
    auto other = lidar::open("file:" + file + suffix, {.model = is_in_name ? nullptr : named});
    ASSERT_TRUE(other) << other.error().message();
    EXPECT_EQ(other->recognition().model, named);
    EXPECT_EQ(other->recognition().by, known_by::user);
    expect_points(played(std::move(other)), stream_.points);
    const auto wrong = lidar::open(file, {.model = &g4_model, .insist_on_model = true});
    ASSERT_FALSE(wrong) << "its packets cannot be read so";
    EXPECT_THAT(wrong.error().message(), HasSubstr("samples of 3 bytes, not of 2"));
  }
}

TEST_F(ModelRecording, TheUserMayInsistOnAnotherModelOfASureOne) {
  const std::string file = recorded_as(t_mini_);
  const model* const other = model_named("t-mini-plus");
  const auto refused = lidar::open(file, {.model = other});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::bad_option);
  EXPECT_THAT(refused.error().message(),
              HasSubstr("t-mini-plus!, or insist_on_model, reads it all the same"));
  EXPECT_EQ(model_of_source({.device = file, .model = other}).error(), problem::bad_option);
  const auto insists = lidar::open(file, {.model = other, .insist_on_model = true});
  ASSERT_TRUE(insists) << insists.error().message();
  EXPECT_EQ(insists->recognition().model, other);
  EXPECT_EQ(insists->recognition().by, known_by::user);
}

TEST_F(ModelRecording, RawBytesOfAnotherModel) {
  const std::string file = path("from_raw.mcap");
  recording_writer writer = made_writer(file);
  {
    auto from = recorded(*open_raw_bytes(raw_file(), {}, {}, {}, t_mini_), writer);
    ASSERT_TRUE(from) << from.error().message();
    expect_points(played(lidar::open(std::move(*from))), stream_.points);
  }
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(recording_reader::open(file)->model().word, "t-mini-pro");
  const std::vector<point> again = played(lidar::open(file));
  expect_points(again, stream_.points);
  // 4000 samples per second, from the rate of the model; the clock may need more than this to settle.
  const auto wanted_ns = static_cast<double>(stream_.points.size() - 1) * 250'000.0;
  EXPECT_NEAR(static_cast<double>(again.back().time_ns - again.front().time_ns), wanted_ns,
              0.1 * wanted_ns);
}

TEST_F(ModelRecording, RawBytesShowTheirModel) {
  EXPECT_EQ(model_of_bytes(raw_file()).word, "t-mini-pro");
  EXPECT_EQ(model_of_bytes(path("missing")).word, "g4");
  expect_points(played(lidar::open(raw_file())), stream_.points);
  const auto as_g4 = lidar::open(raw_file(), {.model = &g4_model});
  ASSERT_FALSE(as_g4) << "its packets cannot be read so";
  EXPECT_EQ(as_g4.error().detail(), error_detail::other_samples);
  EXPECT_THAT(as_g4.error().message(), HasSubstr("samples of 3 bytes, not of 2"));
  const auto refused = lidar::open("sim:", {.model = t_mini_});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("model: t-mini-pro, and the source states g4"));
}

TEST_F(ModelRecording, AReplayedRecordingGivesAnEqualOne) {
  const std::string first = recorded_as(t_mini_);
  recording_writer writer = made_writer(path("again.mcap"));
  {
    auto from = recorded(*replay::open(first), writer);
    ASSERT_TRUE(from) << from.error().message();
    static_cast<void>(played(lidar::open(std::move(*from))));
  }
  ASSERT_TRUE(writer.close());
  const auto reader = recording_reader::open(path("again.mcap"));
  EXPECT_EQ(reader->model().word, "t-mini-pro");
  EXPECT_EQ(reader->digest()->payload, recording_reader::open(first)->digest()->payload);
  EXPECT_THAT(text_of(path("again.mcap")), Not(HasSubstr("/g4lidar/from_device")));
}

TEST_F(ModelRecording, AWriterHasOneModel) {
  recording_writer named = made_writer(path("named.mcap"), {.model = model_named("x4")});
  const auto refused = recorded(*open_raw_bytes(raw_file(), {}, {}, {}, t_mini_), named);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::bad_option);
  EXPECT_THAT(refused.error().message(),
              HasSubstr("model: t-mini-pro, and the recording states x4"));
  recording_writer begun = made_writer(path("begun.mcap"));
  begun.from_device(stream_.data, begin_ns);
  EXPECT_FALSE(recorded(*open_raw_bytes(raw_file(), {}, {}, {}, t_mini_), begun));
  EXPECT_TRUE(recorded(*open_raw_bytes(raw_file(), {}, {}, {}, &g4_model), begun));
}

TEST_F(ModelRecording, EachFileStatesTheModel) {
  recording_writer writer =
      made_writer(path("long.mcap"), {.model = t_mini_, .rotate_time = std::chrono::seconds(1)});
  for (int i = 0; i < 30; ++i) writer.from_device(stream_.data, begin_ns + i * 100 * ms);
  ASSERT_TRUE(writer.close());
  EXPECT_GT(writer.counts().files, 1U);
  EXPECT_EQ(recording_reader::open(path("long-0001.mcap"))->model().word, "t-mini-pro");
}

TEST_F(ModelRecording, ACutOffFileStatesTheModel) {
  const std::string file = path("long.mcap");
  recording_writer writer = made_writer(file, {.model = t_mini_});
  for (int i = 0; i < 30; ++i) writer.from_device(stream_.data, begin_ns + i * 100 * ms);
  ASSERT_TRUE(writer.close());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) * 2 / 3);
  auto reader = recording_reader::open(file);
  ASSERT_TRUE(reader) << reader.error().message();
  EXPECT_TRUE(reader->for_each([](const recorded_item&) { return true; }));
  EXPECT_TRUE(reader->damage().is_cut_off);
  EXPECT_EQ(reader->model().word, "t-mini-pro");
}

// Points without sample flags and intensity have the digest that they had before points had these
// members. Computed with another program: FNV-1a over the words of the members.
TEST(PointDigest, HasAllMembers) {
  const point plain{90.5F, 1234.25F, 0x0000000123456789, 7, point_flags::too_near, 0, 0};
  point_digest old;
  old.add({&plain, 1});
  EXPECT_EQ(old.value(), 0xBF333CA5D3B11496U);
  const point whole{90.5F, 1234.25F, 0x0000000123456789, 7, point_flags::too_near, 3, 0xABCD};
  point_digest with_all;
  with_all.add({&whole, 1});
  EXPECT_EQ(with_all.value(), 0x84323DAB1D6E6196U);
}

}  // namespace
}  // namespace g4lidar::test
