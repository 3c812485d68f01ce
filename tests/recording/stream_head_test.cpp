// SPDX-License-Identifier: MIT
// The first bytes of a pipe: how long they are held back, and that nothing of them is lost.
#include "g4lidar/recording/raw_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "support/family_reference.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using byte_vector = std::vector<std::uint8_t>;
constexpr std::int64_t second_ns = 1'000'000'000;

byte_vector packets_of(std::string_view model, unsigned count) {
  const reference::wire_format& how =
      *std::ranges::find(reference::wire_formats, model, &reference::wire_format::model);
  byte_vector all;
  for (unsigned i = 0; i < count; ++i) {
    const auto made = reference::packet_of(how, 0, 640, 1280,
                                           std::vector<reference::wire_sample>(40, {99 + i, 8002}));
    all.insert(all.end(), made.begin(), made.end());
  }
  return all;
}

TEST(StreamHead, IsCompleteASecondAfterTheFirstPacket) {
  const byte_vector all = packets_of("t-mini", 10);
  stream_head head(7);
  EXPECT_EQ(head.due_ns(), 7 + 10 * second_ns);
  head.take(all, 2 * second_ns);
  EXPECT_FALSE(head.is_complete(2 * second_ns));  // they may still name another model
  EXPECT_EQ(head.due_ns(), 3 * second_ns);
  EXPECT_FALSE(head.is_complete(3 * second_ns - 1));
  EXPECT_TRUE(head.is_complete(3 * second_ns));
  EXPECT_EQ(head.found().which->word, "t-mini-pro");
  EXPECT_TRUE(head.found().is_usual());
  EXPECT_TRUE(std::ranges::equal(head.held(), all));
}

TEST(StreamHead, IsCompleteWhenTheBytesNameTheModel) {
  byte_vector all{0xA5, 0x5A, 0x14, 0, 0, 0, 0x04, 151, 1, 3, 1};
  all.insert(all.end(), 16, 1);
  const byte_vector sent = packets_of("t-mini", 5);
  all.insert(all.end(), sent.begin(), sent.end());
  stream_head head(0);
  head.take(bytes(all).first(27), 1);
  EXPECT_FALSE(head.is_complete(1));
  head.take(bytes(all).subspan(27), 1);
  EXPECT_TRUE(head.is_complete(1));
  EXPECT_EQ(head.found().which->word, "t-mini-plus");
  EXPECT_FALSE(head.found().is_usual());
}

TEST(StreamHead, HoldsABoundedNumberOfBytes) {
  stream_head decided(0);
  decided.take(packets_of("t-mini", 505), 1);  // 130 bytes each
  EXPECT_TRUE(decided.is_complete(1));
  stream_head noise(0);
  noise.take(byte_vector((1U << 20U) - 1), 1);
  EXPECT_FALSE(noise.is_complete(1));
  noise.take(byte_vector(1), 1);
  EXPECT_TRUE(noise.is_complete(1));
}

TEST(StreamHead, IsCompleteAtTheEnd_AndForARecording) {
  stream_head ended(0);
  ended.take(packets_of("t-mini", 3), 1);
  ended.finish();
  EXPECT_TRUE(ended.is_complete(1));
  EXPECT_EQ(ended.found().which->word, "t-mini-pro");
  stream_head recording(0);
  recording.take(byte_vector{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'}, 1);
  EXPECT_TRUE(recording.is_complete(1));
}

/// A pipe; the end for writing can be closed.
class a_pipe {
 public:
  a_pipe() { EXPECT_EQ(::pipe2(ends_.data(), O_CLOEXEC), 0); }
  a_pipe(const a_pipe&) = delete;
  a_pipe& operator=(const a_pipe&) = delete;
  ~a_pipe() {
    ::close(ends_[0]);
    close();
  }
  void write(const byte_vector& data) const {
    EXPECT_EQ(::write(ends_[1], data.data(), data.size()), static_cast<ssize_t>(data.size()));
  }
  void close() {
    if (ends_[1] >= 0) ::close(ends_[1]);
    ends_[1] = -1;
  }
  [[nodiscard]] std::string path() const { return "/dev/fd/" + std::to_string(ends_[0]); }

 private:
  std::array<int, 2> ends_{-1, -1};
};

TEST(PipeOfRawBytes, IsRecognisedWhileItIsOpened_AndLosesNothing) {
  a_pipe made;
  const byte_vector all = packets_of("t-mini", 20);
  made.write(all);
  const auto from = open_raw_bytes(made.path(), {});
  ASSERT_TRUE(from);
  EXPECT_EQ((*from)->traits().recognised.model->word, "t-mini-pro");
  EXPECT_EQ((*from)->traits().recognised.by, known_by::samples);
  const auto port = (*from)->connect();
  ASSERT_TRUE(port);
  const byte_vector later = packets_of("t-mini", 2);
  made.write(later);
  made.close();
  byte_vector got;
  std::array<std::uint8_t, 1000> memory{};
  while (true) {
    const auto read = (*port)->read(memory, (*port)->now_ns() + 10 * second_ns);
    if (!read) {
      EXPECT_EQ(read.error(), problem::end_of_input);
      break;
    }
    got.insert(got.end(), memory.begin(),
               memory.begin() + static_cast<std::ptrdiff_t>(read->count));
  }
  byte_vector wanted = all;
  wanted.insert(wanted.end(), later.begin(), later.end());
  EXPECT_EQ(got, wanted);
}

TEST(PipeOfRawBytes, OfANamedModelIsNotReadAhead) {
  const a_pipe made;  // silent
  const auto from = open_raw_bytes(made.path(), {}, {}, {}, model_named("x4"));
  ASSERT_TRUE(from);
  EXPECT_EQ((*from)->traits().recognised.model->word, "x4");
  EXPECT_EQ((*from)->traits().recognised.by, known_by::user);
}

TEST(PipeOfRawBytes, OpeningASilentOneCanBeCancelled) {
  const a_pipe made;
  std::atomic<int> calls{0};
  const auto from = open_raw_bytes(made.path(), {}, {}, [&] { return ++calls > 2; });
  ASSERT_FALSE(from);
  EXPECT_EQ(from.error(), problem::cancelled);
}

TEST(PipeOfRawBytes, WithoutAWriterIsWaitedFor) {
  const std::string path = testing::TempDir() + "stream_head_test.fifo";
  ::unlink(path.c_str());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::atomic<int> calls{0};
  const auto cancelled = open_raw_bytes(path, {}, {}, [&] { return ++calls > 2; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error(), problem::cancelled);

  const auto from = open_raw_bytes(path, {}, {}, {}, model_named("x4"));
  ASSERT_TRUE(from);
  const auto port = (*from)->connect();
  ASSERT_TRUE(port);
  std::array<std::uint8_t, 100> memory{};
  const auto early = (*port)->read(memory, (*port)->now_ns() + second_ns / 10);
  ASSERT_TRUE(early) << "it ends before there is a writer";
  EXPECT_EQ(early->count, 0U);
  std::ofstream(path) << "bytes";
  const auto got = (*port)->read(memory, (*port)->now_ns() + 10 * second_ns);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->count, 5U);
  const auto end = (*port)->read(memory, (*port)->now_ns() + 10 * second_ns);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error(), problem::end_of_input);
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace g4lidar::test
