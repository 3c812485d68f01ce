// SPDX-License-Identifier: MIT
#include "file_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <new>
#include <tuple>
#include <utility>

#include "file_end.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "summary.hpp"

namespace g4lidar {

using mcap::channel_id;
using mcap::chunk_source;
using mcap::field_reader;
using mcap::opcode;

namespace {

/// In a file without a summary, metadata are searched in this number of blocks at its front.
constexpr int blocks_at_front = 32;
/// The resolution of the search for the begin; the rest is read.
constexpr std::uint64_t near_enough = std::uint64_t{64} << 10U;

/// Odometry may be recorded by this time later than what else has its time.
constexpr std::int64_t late_ns = 1'000'000'000;

/// The sum of two of them does not overflow.
bool is_a_time(std::int64_t time_ns) noexcept {
  constexpr std::int64_t age = std::int64_t{1} << 62U;  // 146 years
  return time_ns > -age && time_ns < age;
}

}  // namespace

recording_reader::file_reader::file_reader(std::shared_ptr<mcap::byte_source> file,
                                           std::string_view path)
    : path_(path), file_(std::move(file)), chunks_(std::make_unique<chunk_source>(file_)) {}

result<std::unique_ptr<recording_reader::file_reader>> recording_reader::file_reader::open(
    std::shared_ptr<mcap::byte_source> file, std::string_view path,
    const reading_options& options) {
  file->cancel_when(options.is_cancelled);
  const bool is_mcap = mcap::has_magic(*file);
  if (const auto& why = file->trouble()) return tl::unexpected(*why);
  if (!is_mcap) return failure(task::opening, problem::bad_file, path);
  std::unique_ptr<file_reader> made(new file_reader(std::move(file), path));
  if (auto begun = made->begin(options); !begun) return tl::unexpected(begun.error());
  return made;
}

result<void> recording_reader::file_reader::begin(const reading_options& options) {
  read_summary();
  read_front();
  const std::optional<recorded_item> first = read();
  if (auto good = check(); !good) return good;
  const bool is_ours = channels_.has_connection();
  if (!is_ours && !channels_.refused().empty()) {
    return failure(task::opening, problem::bad_file, path_ + ", " + channels_.refused(), 0,
                   error_detail::unknown_model);
  }
  if (!is_ours || (!first && damage().any())) {
    return failure(task::opening, problem::bad_file, path_);
  }
  if (!first) {
    is_over_ = true;
    return {};
  }
  const bool is_odometry = first->what == recorded_item::kind::odometry;
  first_ns_ = is_odometry ? first_time_ahead().value_or(first->time_ns) : first->time_ns;
  const auto behind_first = [&](std::int64_t time_ns) {
    return time_ns > never_ns - std::max<std::int64_t>(first_ns_, 0) ? never_ns
                                                                     : first_ns_ + time_ns;
  };
  if (!digest_) find_end();
  to_ns_ = behind_first(std::max<std::int64_t>(options.to_ns, 0));
  if (options.from_ns <= 0) {
    waiting_ = first;
  } else {
    seek(behind_first(options.from_ns));
  }
  return check();
}

result<void> recording_reader::file_reader::check() {
  if (const auto& why = file_->trouble()) return tl::unexpected(*why);
  if (file_->is_cancelled()) return failure(task::reading, problem::cancelled, path_);
  return {};
}

// ---- metadata ----------------------------------------------------------------------------------

/// By the summary.
void recording_reader::file_reader::read_summary() {
  mcap::read_summary(*chunks_, [this](opcode kind, field_reader record) { take(kind, record); });
}

/// The same where there is no summary.
void recording_reader::file_reader::read_front() {
  if (device_ || chunks_->summary_start() != 0) return;
  chunk_source front(file_);
  // What contradicts may be known, and recorded, before the device information.
  const auto is_known = [this] { return device_ && device_->information.is_known(); };
  for (int i = 0; i < blocks_at_front && !is_known(); ++i) {
    const auto block = front.next();
    if (block.records.empty()) break;
    field_reader records(block.records);
    const auto kind = static_cast<opcode>(records.take<std::uint8_t>());
    field_reader record(records.take(records.take<std::uint64_t>()));
    take(kind, record);
  }
}

/// A channel, whose bytes of another model would be read as those of the first one; or metadata.
void recording_reader::file_reader::take(opcode kind, field_reader record) {
  if (kind == opcode::channel) {
    channels_.take(record);
    if (channels_.contradiction().empty() || file_->trouble()) return;
    file_->fail(error(task::reading, problem::bad_file, path_ + ", " + channels_.contradiction(), 0,
                      error_detail::several_models));
  }
  if (kind != opcode::metadata) return;
  const std::string_view name = record.take_text();
  if (name == mcap::device_metadata) device_ = mcap::device_of(record);
  if (name == mcap::digest_metadata) digest_ = mcap::digest_of(record, last_ns_);
}

// ---- reading from there on ---------------------------------------------------------------------

void recording_reader::file_reader::seek(std::int64_t from_ns) {
  from_ns_ = from_ns;
  is_state_reported_ = false;
  transport_ = {};
  const std::optional<std::uint64_t> offset = chunk_before(from_ns);
  chunks_ = std::make_unique<chunk_source>(file_, channels_);
  records_ = {};
  sequence_.reset();
  is_gap_ = false;
  if (offset) chunks_->seek(*offset);
}

/// The last chunk that begins before then, found by bisection: with or without an index.
std::optional<std::uint64_t> recording_reader::file_reader::chunk_before(std::int64_t from_ns) {
  std::optional<std::uint64_t> best;
  std::uint64_t low = 0;
  std::uint64_t high = size();
  while (high - low > near_enough) {
    const std::uint64_t middle = low + (high - low) / 2;
    chunk_source probe(file_, channels_);
    probe.seek(middle);
    std::optional<std::int64_t> time_ns;
    std::uint64_t at = middle;
    while (!time_ns) {
      const auto block = probe.next();
      if (block.records.empty()) break;
      at = block.offset;
      bytes records = block.records;
      time_ns = first_time_in(records);
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

/// A file without a digest was cut off, or is of another program: its end is that of its last chunk.
void recording_reader::file_reader::find_end() {
  const auto kept = std::tuple(sequence_, is_gap_, wall_ahead_ns_);
  last_ns_ = first_ns_;
  for (const std::uint64_t offset : mcap::last_chunks(*file_)) {
    chunk_source tail(file_, channels_);
    tail.seek(offset);
    auto block = tail.next();
    if (block.offset != offset) continue;  // it is damaged
    const std::int64_t before_ns = last_ns_;
    while (const auto time_ns = first_time_in(block.records)) {
      last_ns_ = std::max(last_ns_, *time_ns);
    }
    if (last_ns_ > before_ns) break;
  }
  std::tie(sequence_, is_gap_, wall_ahead_ns_) = kept;
}

/// Of items that are not odometry. Removes the records up to it.
std::optional<std::int64_t> recording_reader::file_reader::first_time_in(bytes& records) {
  field_reader rest(records);
  while (!rest.is_at_end()) {
    const auto kind = static_cast<opcode>(rest.take<std::uint8_t>());
    const field_reader record(rest.take(rest.take<std::uint64_t>()));
    records = rest.rest();
    if (kind == opcode::channel) take(kind, record);
    if (kind != opcode::message) continue;
    const auto item = item_in(record);
    if (item && item->what != recorded_item::kind::odometry) return item->time_ns;
  }
  return std::nullopt;
}

/// The same of the records that follow; they are not read.
std::optional<std::int64_t> recording_reader::file_reader::first_time_ahead() {
  const auto sequence = sequence_;
  bytes records = records_;
  const auto time_ns = first_time_in(records);
  sequence_ = sequence;
  is_gap_ = false;
  return time_ns;
}

/// Skips items before the requested time; the state of the transport at that time is returned
/// first.
std::optional<recorded_item> recording_reader::file_reader::advance() {
  while (true) {
    std::optional<recorded_item> item = std::exchange(waiting_, std::nullopt);
    if (!item) item = read();
    if (!item) return item;
    if (item->time_ns >= to_ns_) {
      const bool is_odometry = item->what == recorded_item::kind::odometry;
      const bool has_odometry = channels_.has(channel_id::odometry);
      is_over_ = !is_odometry &&
                 (!has_odometry || detail::saturating_sub(item->time_ns, to_ns_) >= late_ns);
      if (is_over_) return std::nullopt;
      continue;
    }
    const bool is_event = item->what == recorded_item::kind::other;
    if (item->time_ns < from_ns_) {
      if (is_event) transport_.take(item->other);
      continue;
    }
    if (!std::exchange(is_state_reported_, true) && transport_.is_known) {
      // Otherwise this item is a gap, which does not matter for a reader that begins here.
      if (!waiting_) waiting_ = item;
      item->what = recorded_item::kind::other;
      item->data = {};
      item->other = transport_.as_event(item->time_ns);
    } else if (is_event) {
      transport_.take(item->other);
    }
    return item;
  }
}

result<std::optional<recorded_item>> recording_reader::file_reader::next() noexcept {
  if (is_over_) return std::nullopt;
  try {
    file_->resume();
    auto item = advance();
    if (item && !file_->trouble()) return item;
    return check().map([] { return std::optional<recorded_item>(); });
  } catch (const std::bad_alloc&) {
    return failure(task::reading, problem::system, path_, ENOMEM);
  }
}

/// The next item of the file.
std::optional<recorded_item> recording_reader::file_reader::read() {
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
      // The summary has the last state of the device.
      const bool is_older = kind == opcode::metadata && device_ && chunks_->summary_start() != 0;
      if (!is_older) take(kind, record);
      if (kind != opcode::message) continue;
      auto item = item_in(record);
      if (!item) continue;
      if (item->what == recorded_item::kind::odometry) return item;
      last_ns_ = std::max(last_ns_, item->time_ns);
      if (!std::exchange(is_gap_, false)) return item;
      waiting_ = item;
      item->what = recorded_item::kind::other;
      item->data = {};
      item->other = {.what = recorded_event::kind::gap, .time_ns = item->time_ns};
      return item;
    }
    records_ = chunks_->next().records;
    if (records_.empty()) return std::nullopt;
    if (!wall_ahead_ns_) static_cast<void>(first_time_ahead());  // for odometry before it
  }
}

std::optional<recorded_item> recording_reader::file_reader::item_in(field_reader record) noexcept {
  const auto id = record.take<std::uint16_t>();
  const auto sequence = record.take<std::uint32_t>();
  const auto wall_ns = static_cast<std::int64_t>(record.take<std::uint64_t>());
  static_cast<void>(record.take<std::uint64_t>());
  if (!record.is_good() || !is_a_time(wall_ns)) return std::nullopt;
  const auto is = [&](channel_id which) { return channels_.is(which, id); };
  const bool is_from_device = is(channel_id::from_device);
  if (is_from_device || is(channel_id::to_device)) {
    const auto found = mcap::recorded_bytes_from(record.rest());
    if (!found || !is_a_time(found->time_ns)) return std::nullopt;
    wall_ahead_ns_ = detail::saturating_sub(wall_ns, found->time_ns);
    if (is_from_device && skips(sequence)) is_gap_ = true;
    const auto what =
        is_from_device ? recorded_item::kind::from_device : recorded_item::kind::to_device;
    return recorded_item{what, found->time_ns, wall_ns, found->data, {}};
  }
  if (is(channel_id::odometry)) {
    auto found = mcap::odometry_from(record.rest());
    if (!found || !wall_ahead_ns_) return std::nullopt;
    const std::int64_t stamp_ns = found->time_ns;
    found->time_ns = detail::saturating_sub(stamp_ns, *wall_ahead_ns_);
    if (!is_a_time(stamp_ns) || !is_a_time(found->time_ns)) return std::nullopt;
    return recorded_item{recorded_item::kind::odometry, found->time_ns, stamp_ns, {}, {}, *found};
  }
  if (!is(channel_id::events)) return std::nullopt;
  const auto found = mcap::event_from(record.rest());
  if (!found || !is_a_time(found->time_ns)) return std::nullopt;
  wall_ahead_ns_ = detail::saturating_sub(wall_ns, found->time_ns);
  return recorded_item{recorded_item::kind::other, found->time_ns, wall_ns, {}, *found};
}

/// Whether reads are missing before this one. Files of other programs may not count: then all are
/// 0.
bool recording_reader::file_reader::skips(std::uint32_t sequence) noexcept {
  const auto before = std::exchange(sequence_, sequence);
  return before && sequence != *before + 1 && !(sequence == 0 && *before == 0);
}

const recording_damage& recording_reader::file_reader::damage() const noexcept {
  damage_ = chunks_->damage();
  damage_.bytes_skipped += bytes_skipped_;
  return damage_;
}

}  // namespace g4lidar
