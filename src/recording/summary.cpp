// SPDX-License-Identifier: MIT
#include "summary.hpp"

#include <cstdint>

namespace g4lidar::mcap {
namespace {

using taker = std::function<void(opcode, field_reader)>;

/// The maximum number of each kind.
constexpr int most_records = 1000;

void read_group(chunk_source& file, std::uint64_t at, std::uint64_t end, const taker& take) {
  for (int i = 0; i < most_records && at < end; ++i) {
    const auto channel = file.record_at(at, opcode::channel);
    if (!channel.empty()) {
      take(opcode::channel, field_reader(channel));
      at += record_header_size + channel.size();
      continue;
    }
    const auto index = file.record_at(at, opcode::metadata_index);
    if (index.empty()) return;
    at += record_header_size + index.size();
    const std::uint64_t offset = field_reader(index).take<std::uint64_t>();
    const auto metadata = file.record_at(offset, opcode::metadata);
    if (!metadata.empty()) take(opcode::metadata, field_reader(metadata));
  }
}

}  // namespace

void read_summary(chunk_source& file, const taker& take) {
  const auto start = file.summary_start();
  if (start == 0) return;
  const std::uint64_t footer = file.size() - magic.size() - footer_size;
  const auto content = file.record_at(footer, opcode::footer);
  if (content.size() < 16) return;
  std::uint64_t at = load_u64(content, 8);
  if (at < start || at > footer) return read_group(file, start, footer, take);
  for (int i = 0; i < most_records && at < footer; ++i) {
    const auto offset = file.record_at(at, opcode::summary_offset);
    if (offset.empty()) return;
    field_reader fields(offset);
    at += record_header_size + offset.size();
    const auto kind = static_cast<opcode>(fields.take<std::uint8_t>());
    const auto begin = fields.take<std::uint64_t>();
    const auto length = fields.take<std::uint64_t>();
    if (kind != opcode::channel && kind != opcode::metadata_index) continue;
    if (begin < start || begin > footer || length > footer - begin) continue;
    read_group(file, begin, begin + length, take);
  }
}

}  // namespace g4lidar::mcap
