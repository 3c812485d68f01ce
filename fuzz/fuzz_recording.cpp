// SPDX-License-Identifier: MIT
// The reader of recordings on any bytes, and on damaged recordings.
//
// The input: one byte for its kind. 0: a file, unchanged. Otherwise a recording is made, and the
// rest is a list of changes to it, five bytes each: the place (four bytes, modulo the size of the
// file) and the change (xor). A change of 0 truncates the file there.
//
// Requirements: the reader ends, needs no more memory than one chunk, and returns from a damaged
// recording only recorded items, in order.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "g4lidar/recording/reader.hpp"
#include "recording/mcap/crc32.hpp"
#include "recording/mcap/file_reader.hpp"
#include "recording/mcap/mcap_file.hpp"

namespace {

using g4lidar::bytes;

void insist(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

class memory_file final : public g4lidar::mcap::byte_source {
 public:
  explicit memory_file(bytes data) : data_(data.begin(), data.end()) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return data_.size(); }
  [[nodiscard]] g4lidar::result<std::size_t> read_some(
      std::uint64_t at, std::span<std::uint8_t> out) noexcept override {
    std::size_t count = 0;
    while (count < out.size() && at + count < data_.size()) {
      out[count] = data_[static_cast<std::size_t>(at) + count];
      ++count;
    }
    return count;
  }

 private:
  std::vector<std::uint8_t> data_;
};

constexpr std::size_t reading_size = 24;

std::vector<std::uint8_t> reading(std::int64_t number) {
  return std::vector<std::uint8_t>(reading_size, static_cast<std::uint8_t>(number));
}

/// A file of a writer, with four chunks, each with a checksum.
std::vector<std::uint8_t> made_recording() {
  using namespace g4lidar::mcap;
  record_text file;
  file.put(bytes(magic));
  std::int64_t number = 0;
  std::uint32_t sequence = 0;
  for (int i = 0; i < 4; ++i) {
    open_chunk chunk;
    channel_set().put_channels(chunk.text());
    for (int k = 0; k < 3; ++k, ++number) {
      chunk.begin_message(channel_id::from_device, sequence++, number);
      put_recorded_bytes(chunk.text(), reading(number), number);
      chunk.end_message();
    }
    const std::size_t record = file.begin(opcode::chunk);
    file.put(chunk.first_ns());
    file.put(chunk.last_ns());
    file.put(static_cast<std::uint64_t>(chunk.records().size()));
    file.put(crc32_of(chunk.records()));
    file.put("");
    file.put(static_cast<std::uint64_t>(chunk.records().size()));
    file.put(chunk.records());
    file.end(record);
  }
  return {file.all().begin(), file.all().end()};
}

/// Reads all of it. Checks the items if `is_ours`.
void read(bytes file, const g4lidar::reading_options& how, bool is_ours) {
  auto reader = g4lidar::recording_access::open(std::make_shared<memory_file>(file), "memory", how);
  if (!reader) return;
  std::int64_t last = -1;
  std::uint64_t items = 0;
  while (true) {
    const auto item = reader->next();
    if (!item || !*item) break;
    insist(++items <= 4 * file.size() + 16'000'000, "it does not end");
    if (!is_ours || (*item)->what != g4lidar::recorded_item::kind::from_device) continue;
    insist((*item)->time_ns > last && (*item)->time_ns < 12, "out of order");
    last = (*item)->time_ns;
    const auto wanted = reading(last);
    const bytes got = (*item)->data;
    insist(std::vector<std::uint8_t>(got.begin(), got.end()) == wanted, "not what was recorded");
  }
  insist(reader->damage().bytes_skipped <= 8 * file.size() + 64, "more skipped than there is");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bytes input(data + 1, size - 1);
  if (data[0] == 0) {
    read(input, {}, false);
    read(input, {.from_ns = 1'000'000'000}, false);
    return 0;
  }
  std::vector<std::uint8_t> file = made_recording();
  for (std::size_t at = 0; at + 5 <= input.size() && !file.empty(); at += 5) {
    const std::size_t place = g4lidar::load_u32(input, at) % file.size();
    if (input[at + 4] == 0) {
      file.resize(place);
    } else {
      file[place] = static_cast<std::uint8_t>(file[place] ^ input[at + 4]);
    }
  }
  // With more changes a chunk without a checksum is possible.
  const bool is_ours = input.size() < 4 * 5;
  read(file, {}, is_ours);
  read(file, {.from_ns = 5}, is_ours);
  return 0;
}
