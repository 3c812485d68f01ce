// SPDX-License-Identifier: MIT
#include "summary.hpp"

#include <cstdint>

namespace g4lidar::mcap {
namespace {

using taker = std::function<void(opcode, field_reader)>;

/// What may be read: of a real file each record once. Groups may overlap, and many indexes may have the same metadata.
struct budget {
  int records = 3000;
  std::uint64_t bytes;

  [[nodiscard]] bool spend(std::size_t size) noexcept {
    if (records == 0 || bytes < size) {
      records = 0;  // nothing more
      return false;
    }
    --records;
    bytes -= size;
    return true;
  }
};

void read_group(chunk_source& file, std::uint64_t position, std::uint64_t end, budget& left,
                const taker& take) {
  while (position < end) {
    const auto channel = file.record_at(position, opcode::channel);
    if (!left.spend(record_header_size + channel.size())) return;
    if (!channel.empty()) {
      take(opcode::channel, field_reader(channel));
      position += record_header_size + channel.size();
      continue;
    }
    const auto index = file.record_at(position, opcode::metadata_index);
    if (index.empty()) return;
    position += record_header_size + index.size();
    const std::uint64_t offset = field_reader(index).take<std::uint64_t>();
    const auto metadata = file.record_at(offset, opcode::metadata);
    if (!left.spend(metadata.size())) return;
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
  budget left{.bytes = 2 * file.size()};
  if (at < start || at > footer) return read_group(file, start, footer, left, take);
  while (at < footer) {
    const auto offset = file.record_at(at, opcode::summary_offset);
    if (offset.empty() || !left.spend(record_header_size + offset.size())) return;
    field_reader fields(offset);
    at += record_header_size + offset.size();
    const auto kind = static_cast<opcode>(fields.take<std::uint8_t>());
    const auto begin = fields.take<std::uint64_t>();
    const auto length = fields.take<std::uint64_t>();
    if (kind != opcode::channel && kind != opcode::metadata_index) continue;
    if (begin < start || begin > footer || length > footer - begin) continue;
    read_group(file, begin, begin + length, left, take);
  }
}

}  // namespace g4lidar::mcap
