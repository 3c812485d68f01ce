// SPDX-License-Identifier: MIT
#include "mcap_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "g4lidar/version.hpp"
#include "transport/system_calls.hpp"

namespace g4lidar::mcap {
namespace {

/// Parts of the summary.
constexpr std::size_t summary_piece = std::size_t{64} << 10U;
/// Reserved for a chunk and its indexes, so that writing one does not allocate.
constexpr std::size_t text_room = std::size_t{1536} << 10U;

std::string library_name() {
  const version& of = header_version;
  return "g4lidar " + std::to_string(of.major_number) + "." + std::to_string(of.minor_number) +
         "." + std::to_string(of.patch_number);
}

}  // namespace

// ---- open_chunk --------------------------------------------------------------------------------

open_chunk::open_chunk() {
  text_.reserve(room + (std::size_t{64} << 10U));
  for (auto& places : places_) places.reserve(most_messages);
}

void open_chunk::begin_message(channel_id id, std::uint32_t sequence, std::int64_t wall_ns) {
  const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(wall_ns, 0));
  places_[index_of(id)].push_back({time_ns, text_.size()});
  begun_ = text_.begin(opcode::message);
  text_.put(static_cast<std::uint16_t>(id));
  text_.put(sequence);
  text_.put(time_ns);
  text_.put(time_ns);
  first_ns_ = std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  ++count_;
}

void open_chunk::clear() noexcept {
  text_.clear();
  for (auto& places : places_) places.clear();
  count_ = 0;
  first_ns_ = std::numeric_limits<std::uint64_t>::max();
  last_ns_ = 0;
}

// ---- mcap_file ---------------------------------------------------------------------------------

result<mcap_file> mcap_file::create(const std::string& path, const channel_set& channels,
                                    bool overwrite) {
  auto file = new_file::create(path, overwrite);
  if (!file) return tl::unexpected(file.error());
  mcap_file made(*std::move(file));
  made.text_.reserve(text_room);
  if (auto written = made.begin(channels); !written) {
    made.file_.remove();
    return tl::unexpected(written.error());
  }
  return made;
}

result<void> mcap_file::begin(const channel_set& channels) {
  channels_ = channels;
  text_.clear();
  for (const std::uint8_t each : magic)
    text_.put(each);  // g++ 12 warns of the range, without a reason
  const std::size_t header = text_.begin(opcode::header);
  text_.put("ros2");
  text_.put(std::string_view(library_name()));
  text_.end(header);
  channels_.put_schemas(text_);
  channels_.put_channels(text_);
  crc_ = crc32();
  if (std::exchange(offset_, 0) != 0) {
    static_cast<void>(uninterrupted([&] { return ::ftruncate(file_.fd(), 0); }));
  }
  return write(text_.all());
}

result<void> mcap_file::write_all(bytes data) noexcept {
  std::size_t done = 0;
  while (done < data.size()) {
    const bytes rest = data.subspan(done);
    const ssize_t count = uninterrupted([&] {
      return ::pwrite(file_.fd(), rest.data(), rest.size(), static_cast<off_t>(offset_ + done));
    });
    if (count <= 0) return failure(task::writing, problem::system, path(), count < 0 ? errno : EIO);
    done += static_cast<std::size_t>(count);
  }
  return {};
}

/// Completely, or not at all.
result<void> mcap_file::write(bytes data) {
  auto done = write_all(data);
  if (!done) {
    static_cast<void>(
        uninterrupted([&] { return ::ftruncate(file_.fd(), static_cast<off_t>(offset_)); }));
    return done;
  }
  crc_.add(data);
  offset_ += data.size();
  return {};
}

result<void> mcap_file::add(const open_chunk& chunk, bytes packed) {
  const bytes stored = packed.empty() ? chunk.records() : packed;
  chunk_place place{};
  place.first_ns = chunk.first_ns();
  place.last_ns = chunk.last_ns();
  place.offset = offset_;
  place.size = chunk.records().size();
  place.packed_size = stored.size();
  place.is_packed = !packed.empty();
  text_.clear();
  const std::size_t record = text_.begin(opcode::chunk);
  text_.put(place.first_ns);
  text_.put(place.last_ns);
  text_.put(place.size);
  text_.put(crc32_of(chunk.records()));
  text_.put(place.is_packed ? "zstd" : "");
  text_.put(place.packed_size);
  text_.put(stored);
  text_.end(record);
  place.length = text_.size();
  for (const topic_words& channel : all_topics()) {
    const auto places = chunk.places(channel.id);
    if (places.empty()) continue;
    place.index_offsets[index_of(channel.id)] = offset_ + text_.size();
    const std::size_t index = text_.begin(opcode::message_index);
    text_.put(static_cast<std::uint16_t>(channel.id));
    const std::size_t array = text_.begin<std::uint32_t>();
    for (const auto& [wall_ns, offset] : places) {
      text_.put(wall_ns);
      text_.put(offset);
    }
    text_.end<std::uint32_t>(array);
    text_.end(index);
  }
  place.index_length = text_.size() - place.length;
  if (auto written = write(text_.all()); !written) return written;
  for (const topic_words& channel : all_topics()) {
    messages_[index_of(channel.id)] += chunk.places(channel.id).size();
  }
  chunks_.push_back(place);
  return {};
}

result<void> mcap_file::extend(const channel_set& channels) {
  text_.clear();
  channels.put_schemas(text_, &channels_);
  channels.put_channels(text_);
  auto written = write(text_.all());
  if (written) channels_ = channels;
  return written;
}

result<void> mcap_file::add_metadata(std::string_view name, const word_map& words) {
  text_.clear();
  const std::size_t record = text_.begin(opcode::metadata);
  text_.put(name);
  put_map(text_, words);
  text_.end(record);
  const std::uint64_t offset = offset_;
  if (auto written = write(text_.all()); !written) return written;
  metadata_.push_back({offset, text_.size(), std::string(name)});
  return {};
}

std::uint64_t mcap_file::closed_size() const noexcept {
  constexpr std::uint64_t of_summary = 12'288;  // with all schemas
  constexpr std::uint64_t of_chunk = 120 + 10 * topic_count;
  return offset_ + of_summary + of_chunk * (chunks_.size() + 1);
}

result<void> mcap_file::close() {
  if (auto ended = end_data(); !ended) return ended;
  return summarise();
}

result<void> mcap_file::end_data() {
  text_.clear();
  const std::size_t record = text_.begin(opcode::data_end);
  text_.put(crc_.value());
  text_.end(record);
  return write(text_.all());
}

void mcap_file::put_statistics() {
  std::uint64_t all = 0;
  for (const std::uint64_t count : messages_) all += count;
  std::uint64_t first_ns = chunks_.empty() ? 0 : std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  for (const chunk_place& chunk : chunks_) {
    first_ns = std::min(first_ns, chunk.first_ns);
    last_ns = std::max(last_ns, chunk.last_ns);
  }
  const std::size_t record = text_.begin(opcode::statistics);
  text_.put(all);
  text_.put(channels_.schema_count());
  text_.put(channels_.count());
  text_.put(std::uint32_t{0});
  text_.put(static_cast<std::uint32_t>(metadata_.size()));
  text_.put(static_cast<std::uint32_t>(chunks_.size()));
  text_.put(first_ns);
  text_.put(last_ns);
  const std::size_t counts = text_.begin<std::uint32_t>();
  for (const topic_words& channel : all_topics()) {
    if (!channels_.has(channel.id)) continue;
    text_.put(static_cast<std::uint16_t>(channel.id));
    text_.put(messages_[index_of(channel.id)]);
  }
  text_.end<std::uint32_t>(counts);
  text_.end(record);
}

void mcap_file::put_chunk_index(const chunk_place& of) {
  const std::size_t record = text_.begin(opcode::chunk_index);
  text_.put(of.first_ns);
  text_.put(of.last_ns);
  text_.put(of.offset);
  text_.put(of.length);
  const std::size_t offsets = text_.begin<std::uint32_t>();
  for (const topic_words& channel : all_topics()) {
    const std::uint64_t offset = of.index_offsets[index_of(channel.id)];
    if (offset == 0) continue;
    text_.put(static_cast<std::uint16_t>(channel.id));
    text_.put(offset);
  }
  text_.end<std::uint32_t>(offsets);
  text_.put(of.index_length);
  text_.put(of.is_packed ? "zstd" : "");
  text_.put(of.packed_size);
  text_.put(of.size);
  text_.end(record);
}

/// The groups of the summary, with their offsets, and the footer, whose checksum covers all of
/// them.
result<void> mcap_file::summarise() {
  struct group {
    opcode kind;
    std::uint64_t begin;
    std::uint64_t end;
  };
  std::vector<group> groups;
  const std::uint64_t summary_start = offset_;
  crc_ = crc32();
  text_.clear();
  const auto flush = [&](std::size_t least) -> result<void> {
    if (text_.size() < least) return {};
    auto written = write(text_.all());
    text_.clear();
    return written;
  };
  const auto begin = [&](opcode kind) {
    const std::uint64_t at = offset_ + text_.size();
    if (!groups.empty()) groups.back().end = at;
    groups.push_back({kind, at, at});
  };
  begin(opcode::schema);
  channels_.put_schemas(text_);
  begin(opcode::channel);
  channels_.put_channels(text_);
  begin(opcode::statistics);
  put_statistics();
  begin(opcode::chunk_index);
  for (const chunk_place& chunk : chunks_) {
    put_chunk_index(chunk);
    if (auto flushed = flush(summary_piece); !flushed) return flushed;
  }
  begin(opcode::metadata_index);
  for (const metadata_place& place : metadata_) {
    const std::size_t record = text_.begin(opcode::metadata_index);
    text_.put(place.offset);
    text_.put(place.length);
    text_.put(std::string_view(place.name));
    text_.end(record);
  }
  const std::uint64_t offsets_start = offset_ + text_.size();
  groups.back().end = offsets_start;
  for (const group& of : groups) {
    if (of.begin == of.end) continue;
    const std::size_t record = text_.begin(opcode::summary_offset);
    text_.put(static_cast<std::uint8_t>(of.kind));
    text_.put(of.begin);
    text_.put(of.end - of.begin);
    text_.end(record);
  }
  const std::size_t footer = text_.begin(opcode::footer);
  text_.put(summary_start);
  text_.put(offsets_start);
  text_.put(std::uint32_t{0});
  text_.end(footer);
  crc_.add(text_.all().first(text_.size() - 4));
  text_.set(text_.size() - 4, crc_.value());
  text_.put(bytes(magic));
  return flush(0);
}

}  // namespace g4lidar::mcap
