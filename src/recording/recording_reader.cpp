// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <new>
#include <utility>

#include "file_reader.hpp"

namespace g4lidar {

using mcap::chunk_source;
using mcap::field_reader;
using mcap::opcode;
using mcap::record_header_size;
using mcap::topic;

namespace {

/// Where the file has no summary, its metadata are looked for in so many blocks at its front.
constexpr int blocks_at_front = 32;
/// Of one kind in a summary.
constexpr int most_records = 1000;
/// Where to begin is looked for no finer than this: the rest is read.
constexpr std::uint64_t near_enough = std::uint64_t{64} << 10U;

/// Two of them can be added.
bool is_a_time(std::int64_t time_ns) noexcept {
  constexpr std::int64_t age = std::int64_t{1} << 62U;  // 146 years
  return time_ns > -age && time_ns < age;
}

template <class Number>
Number number_in(std::string_view text, int base = 10) noexcept {
  Number value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

}  // namespace

bool is_recording(std::string_view path) noexcept {
  try {
    const auto file = mcap::open_file_source(path);
    if (!file) return false;
    std::array<std::uint8_t, mcap::magic.size()> begin{};
    const auto count = (*file)->read(0, begin);
    return count && *count == begin.size() && begin == mcap::magic;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

recording_reader::file_reader::file_reader(std::shared_ptr<mcap::byte_source> file,
                                           std::string_view path)
    : path_(path), file_(std::move(file)), chunks_(std::make_unique<chunk_source>(file_)) {}

result<std::unique_ptr<recording_reader::file_reader>> recording_reader::file_reader::open(
    std::shared_ptr<mcap::byte_source> file, std::string_view path,
    const reading_options& options) {
  std::array<std::uint8_t, mcap::magic.size()> begin{};
  const auto count = file->read(0, begin);
  if (!count) return tl::unexpected(count.error());
  if (*count < begin.size() || begin != mcap::magic) {
    return failure(task::opening, problem::bad_file, path);
  }
  std::unique_ptr<file_reader> made(new file_reader(std::move(file), path));
  if (auto begun = made->begin(options); !begun) return tl::unexpected(begun.error());
  return made;
}

result<void> recording_reader::file_reader::begin(const reading_options& options) {
  if (auto read = read_summary(); !read) return read;
  if (auto read = read_front(); !read) return read;
  const auto found = read();
  if (!found) return tl::unexpected(found.error());
  const std::optional<recorded_item> first = *found;
  const bool is_ours =
      std::ranges::any_of(channels_, [](const auto& id) { return id.has_value(); });
  if (!is_ours || (!first && damage().any())) {
    return failure(task::opening, problem::bad_file, path_);
  }
  if (!first) {
    is_over_ = true;
    return {};
  }
  first_ns_ = first->time_ns;
  const auto behind_first = [&](std::int64_t time_ns) {
    return time_ns > never_ns - std::max<std::int64_t>(first_ns_, 0) ? never_ns
                                                                     : first_ns_ + time_ns;
  };
  to_ns_ = behind_first(std::max<std::int64_t>(options.to_ns, 0));
  if (options.from_ns <= 0) {
    waiting_ = first;
    return {};
  }
  return seek(behind_first(options.from_ns));
}

// ---- what is known beforehand -------------------------------------------------------------------

/// Channels and metadata, by the groups of the summary.
result<void> recording_reader::file_reader::read_summary() {
  const auto start = chunks_->summary_start();
  if (!start) return tl::unexpected(start.error());
  if (*start == 0) return {};
  const std::uint64_t footer = size() - mcap::magic.size() - mcap::footer_size;
  const auto content = chunks_->record_at(footer, opcode::footer);
  if (!content) return tl::unexpected(content.error());
  if (content->size() < 16) return {};
  std::uint64_t at = load_u64(*content, 8);
  if (at < *start || at > footer) return read_group(*start, footer);
  for (int i = 0; i < most_records && at < footer; ++i) {
    const auto offset = chunks_->record_at(at, opcode::summary_offset);
    if (!offset) return tl::unexpected(offset.error());
    if (offset->empty()) return {};
    field_reader fields(*offset);
    at += record_header_size + offset->size();
    const auto kind = static_cast<opcode>(fields.take<std::uint8_t>());
    const auto begin = fields.take<std::uint64_t>();
    const auto length = fields.take<std::uint64_t>();
    if (kind != opcode::channel && kind != opcode::metadata_index) continue;
    if (begin < *start || begin > footer || length > footer - begin) continue;
    if (auto read = read_group(begin, begin + length); !read) return read;
  }
  return {};
}

result<void> recording_reader::file_reader::read_group(std::uint64_t at, std::uint64_t end) {
  for (int i = 0; i < most_records && at < end; ++i) {
    const auto channel = chunks_->record_at(at, opcode::channel);
    if (!channel) return tl::unexpected(channel.error());
    if (!channel->empty()) {
      take_channel(field_reader(*channel));
      at += record_header_size + channel->size();
      continue;
    }
    const auto index = chunks_->record_at(at, opcode::metadata_index);
    if (!index) return tl::unexpected(index.error());
    if (index->empty()) return {};
    at += record_header_size + index->size();
    const std::uint64_t offset = field_reader(*index).take<std::uint64_t>();
    const auto metadata = chunks_->record_at(offset, opcode::metadata);
    if (!metadata) return tl::unexpected(metadata.error());
    if (!metadata->empty()) take_metadata(field_reader(*metadata));
  }
  return {};
}

/// The same where there is no summary.
result<void> recording_reader::file_reader::read_front() {
  if (device_) return {};
  chunk_source front(file_);
  for (int i = 0; i < blocks_at_front && !device_; ++i) {
    const auto block = front.next();
    if (!block) return tl::unexpected(block.error());
    if (block->records.empty()) break;
    field_reader records(block->records);
    const auto kind = static_cast<opcode>(records.take<std::uint8_t>());
    field_reader record(records.take(records.take<std::uint64_t>()));
    if (kind == opcode::metadata) take_metadata(record);
    if (kind == opcode::channel) take_channel(record);
  }
  return {};
}

void recording_reader::file_reader::take_channel(field_reader record) noexcept {
  const auto id = record.take<std::uint16_t>();
  static_cast<void>(record.take<std::uint16_t>());
  const std::string_view name = record.take_text();
  const std::string_view encoding = record.take_text();
  if (!record.is_good() || encoding != "cdr") return;
  for (const mcap::topic_words& known : mcap::all_topics()) {
    if (known.id != topic::scan && known.name == name) {
      channels_[static_cast<std::size_t>(known.id) - 1] = id;
    }
  }
}

void recording_reader::file_reader::take_metadata(field_reader record) {
  const std::string_view name = record.take_text();
  if (name == mcap::device_metadata) device_ = mcap::device_of(record);
  if (name == mcap::digest_metadata) take_digest(record);
}

void recording_reader::file_reader::take_digest(field_reader record) {
  field_reader words(record.take(record.take<std::uint32_t>()));
  recorded_digest found;
  while (!words.is_at_end() && words.is_good()) {
    const std::string_view name = words.take_text();
    const std::string_view value = words.take_text();
    if (name == "payload") found.payload = number_in<std::uint64_t>(value, 16);
    if (name == "points") found.points = number_in<std::uint64_t>(value, 16);
    if (name == "point_count") found.point_count = number_in<std::uint64_t>(value);
    if (name == "computed_with") found.is_comparable = value == computed_with();
    if (name == "last_ns") last_ns_ = number_in<std::int64_t>(value);
  }
  digest_ = found;
}

// ---- from there on ------------------------------------------------------------------------------

result<void> recording_reader::file_reader::seek(std::int64_t from_ns) {
  from_ns_ = from_ns;
  is_line_told_ = false;
  line_ = {};
  const auto found = chunk_before(from_ns);
  if (!found) return tl::unexpected(found.error());
  const std::optional<std::uint64_t> offset = *found;
  chunks_ = std::make_unique<chunk_source>(file_);
  records_ = {};
  sequence_.reset();
  is_gap_ = false;
  if (offset) chunks_->seek(*offset);
  return {};
}

/// The last chunk that begins before then, found by halving the file: with or without an index.
result<std::optional<std::uint64_t>> recording_reader::file_reader::chunk_before(
    std::int64_t from_ns) {
  std::optional<std::uint64_t> best;
  std::uint64_t low = 0;
  std::uint64_t high = size();
  while (high - low > near_enough) {
    const std::uint64_t middle = low + (high - low) / 2;
    chunk_source probe(file_);
    probe.seek(middle);
    std::optional<std::int64_t> time_ns;
    std::uint64_t at = middle;
    while (!time_ns) {
      const auto block = probe.next();
      if (!block) return tl::unexpected(block.error());
      if (block->records.empty()) break;
      at = block->offset;
      time_ns = first_time_in(block->records);
    }
    if (time_ns && *time_ns <= from_ns && at < high) {
      best = at;
      low = std::max(at, middle);
    } else {
      high = middle;
    }
  }
  return best;
}

std::optional<std::int64_t> recording_reader::file_reader::first_time_in(bytes records) noexcept {
  field_reader rest(records);
  while (!rest.is_at_end()) {
    const auto kind = static_cast<opcode>(rest.take<std::uint8_t>());
    const field_reader record(rest.take(rest.take<std::uint64_t>()));
    if (kind == opcode::channel) take_channel(record);
    if (kind != opcode::message) continue;
    if (const auto item = item_in(record)) return item->time_ns;
  }
  return std::nullopt;
}

/// What was not asked for is passed over; how the line stands then is told first.
result<std::optional<recorded_item>> recording_reader::file_reader::advance() {
  while (true) {
    std::optional<recorded_item> item = std::exchange(waiting_, std::nullopt);
    if (!item) {
      const auto found = read();
      if (!found) return found;
      item = *found;
    }
    if (!item) return item;
    if (item->time_ns >= to_ns_) {
      is_over_ = true;
      return std::nullopt;
    }
    const bool is_note = item->what == recorded_item::kind::note;
    if (item->time_ns < from_ns_) {
      if (is_note) line_.take(item->note);
      continue;
    }
    if (!std::exchange(is_line_told_, true) && line_.is_known) {
      if (!waiting_) waiting_ = item;  // else this one is a gap, which nobody joining here minds
      item->what = recorded_item::kind::note;
      item->data = {};
      item->note = line_.as_note(item->time_ns);
    } else if (is_note) {
      line_.take(item->note);
    }
    return item;
  }
}

result<std::optional<recorded_item>> recording_reader::file_reader::next() noexcept {
  if (is_over_) return std::nullopt;
  try {
    return advance();
  } catch (const std::bad_alloc&) {
    return failure(task::reading, problem::system, path_, ENOMEM);
  }
}

/// The next thing in the file.
result<std::optional<recorded_item>> recording_reader::file_reader::read() {
  while (true) {
    while (!records_.empty()) {
      field_reader rest(records_);
      const auto kind = static_cast<opcode>(rest.take<std::uint8_t>());
      const field_reader record(rest.take(rest.take<std::uint64_t>()));
      if (!rest.is_good()) {
        bytes_skipped_ += records_.size();
        records_ = {};
        break;
      }
      records_ = rest.rest();
      if (kind == opcode::channel) take_channel(record);
      if (kind == opcode::metadata) take_metadata(record);
      if (kind != opcode::message) continue;
      auto item = item_in(record);
      if (!item) continue;
      last_ns_ = std::max(last_ns_, item->time_ns);
      if (!std::exchange(is_gap_, false)) return item;
      waiting_ = item;
      item->what = recorded_item::kind::note;
      item->data = {};
      item->note = {.what = line_note::kind::gap, .time_ns = item->time_ns};
      return item;
    }
    const auto block = chunks_->next();
    if (!block) return tl::unexpected(block.error());
    if (block->records.empty()) return std::nullopt;
    records_ = block->records;
  }
}

std::optional<recorded_item> recording_reader::file_reader::item_in(field_reader record) noexcept {
  const auto id = record.take<std::uint16_t>();
  const auto sequence = record.take<std::uint32_t>();
  const auto wall_ns = static_cast<std::int64_t>(record.take<std::uint64_t>());
  static_cast<void>(record.take<std::uint64_t>());
  if (!record.is_good() || !is_a_time(wall_ns)) return std::nullopt;
  const auto is = [&](topic which) { return channels_[static_cast<std::size_t>(which) - 1] == id; };
  const bool is_from_device = is(topic::from_device);
  if (is_from_device || is(topic::to_device)) {
    const auto found = mcap::line_bytes_from(record.rest());
    if (!found || !is_a_time(found->time_ns)) return std::nullopt;
    if (is_from_device && skips(sequence)) is_gap_ = true;
    const auto what =
        is_from_device ? recorded_item::kind::from_device : recorded_item::kind::to_device;
    return recorded_item{what, found->time_ns, wall_ns, found->data, {}};
  }
  if (!is(topic::notes)) return std::nullopt;
  const auto note = mcap::note_from(record.rest());
  if (!note || !is_a_time(note->time_ns)) return std::nullopt;
  return recorded_item{recorded_item::kind::note, note->time_ns, wall_ns, {}, *note};
}

/// Whether readings are missing before this one. Files of others may not count: all are 0 then.
bool recording_reader::file_reader::skips(std::uint32_t sequence) noexcept {
  const auto before = std::exchange(sequence_, sequence);
  return before && sequence != *before + 1 && !(sequence == 0 && *before == 0);
}

const recording_damage& recording_reader::file_reader::damage() const noexcept {
  damage_ = chunks_->damage();
  damage_.bytes_skipped += bytes_skipped_;
  return damage_;
}

// ---- recording_reader ---------------------------------------------------------------------------

recording_reader::recording_reader(std::unique_ptr<file_reader> made) noexcept
    : made_(std::move(made)) {}
recording_reader::recording_reader(recording_reader&&) noexcept = default;
recording_reader& recording_reader::operator=(recording_reader&&) noexcept = default;
recording_reader::~recording_reader() = default;

result<recording_reader> recording_reader::open(std::string_view path,
                                                const reading_options& options) {
  auto file = mcap::open_file_source(path);
  if (!file) return tl::unexpected(file.error());
  return recording_access::open(std::move(*file), path, options);
}

result<recording_reader> recording_access::open(std::shared_ptr<mcap::byte_source> file,
                                                std::string_view path,
                                                const reading_options& options) {
  auto made = recording_reader::file_reader::open(std::move(file), path, options);
  if (!made) return tl::unexpected(made.error());
  return recording_reader(std::move(*made));
}

result<std::optional<recorded_item>> recording_reader::next() noexcept { return made_->next(); }
const std::optional<recorded_device>& recording_reader::device() const noexcept {
  return made_->device();
}
const std::optional<recorded_digest>& recording_reader::digest() const noexcept {
  return made_->digest();
}
std::int64_t recording_reader::first_ns() const noexcept { return made_->first_ns(); }
std::int64_t recording_reader::last_ns() const noexcept { return made_->last_ns(); }
const recording_damage& recording_reader::damage() const noexcept { return made_->damage(); }
std::uint64_t recording_reader::position() const noexcept { return made_->position(); }
std::uint64_t recording_reader::size() const noexcept { return made_->size(); }

}  // namespace g4lidar
