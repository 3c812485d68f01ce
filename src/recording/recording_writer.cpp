// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <new>
#include <utility>

#include "../device/subject.hpp"
#include "file_writer.hpp"
#include "g4lidar/grid.hpp"

namespace g4lidar {
namespace {

/// Bytes in one message; a driver reads fewer.
constexpr std::size_t largest_piece = std::size_t{64} << 10U;
/// Beside the data, in a message of any kind.
constexpr std::size_t message_room = 1024;
constexpr std::size_t largest_grid = 65536;
constexpr std::size_t longest_name = 255;
constexpr std::uint64_t least_rotate_bytes = std::uint64_t{1} << 20U;

std::int64_t ns_of(std::chrono::nanoseconds time) noexcept { return time.count(); }

/// The steady clock is read on both sides, so that who is held up in between sees it.
std::int64_t wall_ahead_now() noexcept {
  using std::chrono::steady_clock;
  using std::chrono::system_clock;
  const std::int64_t before = ns_of(steady_clock::now().time_since_epoch());
  const std::int64_t wall = ns_of(system_clock::now().time_since_epoch());
  const std::int64_t after = ns_of(steady_clock::now().time_since_epoch());
  return wall - (before + (after - before) / 2);
}

/// A whole name as ROS has them: parts of letters, digits and single underscores, none of which begins
/// with a digit.
bool is_topic(std::string_view name) noexcept {
  const auto is_digit = [](char of) { return of >= '0' && of <= '9'; };
  const auto is_letter = [](char of) {
    return (of >= 'a' && of <= 'z') || (of >= 'A' && of <= 'Z');
  };
  if (name.empty() || name.size() > longest_name || name.front() != '/') return false;
  char before = 0;
  for (const char each : name) {
    if (!is_digit(each) && !is_letter(each) && each != '_' && each != '/') return false;
    if (before == '/' && (each == '/' || is_digit(each))) return false;
    if (before == '_' && each == '_') return false;
    before = each;
  }
  return before != '/';
}

/// Which a reader takes for something else.
bool is_our_own(std::string_view name) noexcept {
  return std::ranges::any_of(mcap::all_topics(), [&](const mcap::topic_words& known) {
    return known.id != mcap::topic::scan && known.name == name;
  });
}

std::optional<error> problem_with(const recording_options& options) noexcept {
  using namespace std::chrono_literals;
  const auto bad = [](std::string_view what) {
    return error(task::configuring, problem::bad_option, what);
  };
  if (options.packed == packing::zstd && !has_zstd()) return bad("packed: built without zstd");
  if (options.chunk_time < 10ms || options.chunk_time > 10s)
    return bad("chunk_time: 10 ms to 10 s");
  if (options.rotate_bytes != 0 && options.rotate_bytes < least_rotate_bytes) {
    return bad("rotate_bytes: 0, or at least 1048576");
  }
  if (options.rotate_time < 0s || options.rotate_time > 10 * 365 * 24h) {
    return bad("rotate_time: 0, or at least 1 s");
  }
  if (options.scan_bins == 0 || options.scan_bins > largest_grid)
    return bad("scan_bins: 1 to 65536");
  if (!is_topic(options.topic)) return bad("topic: a whole name as ROS has them, like /front/scan");
  if (is_our_own(options.topic)) return bad("topic: one of the recording's own");
  if (options.frame_id.size() > longest_name) return bad("frame_id: at most 255 bytes");
  return std::nullopt;
}

/// Of the messages of a chunk.
payload_digest payload_of(bytes records) noexcept {
  payload_digest sum;
  mcap::field_reader rest(records);
  while (!rest.is_at_end()) {
    const auto kind = static_cast<mcap::opcode>(rest.take<std::uint8_t>());
    mcap::field_reader record(rest.take(rest.take<std::uint64_t>()));
    if (kind != mcap::opcode::message) continue;
    const auto id = static_cast<mcap::topic>(record.take<std::uint16_t>());
    static_cast<void>(record.take(mcap::message_header_size - sizeof(std::uint16_t)));
    if (id != mcap::topic::from_device && id != mcap::topic::to_device) continue;
    const auto way = id == mcap::topic::from_device ? direction::from_device : direction::to_device;
    if (const auto found = mcap::line_bytes_from(record.rest())) sum.add(way, found->data);
  }
  return sum;
}

std::string hexadecimal(std::uint64_t value) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

}  // namespace

using mcap::topic;

recording_writer::file_writer::file_writer(mcap::mcap_file first, std::string_view path,
                                           const recording_options& options)
    : options_(options),
      first_path_(path),
      file_(std::make_unique<mcap::mcap_file>(std::move(first))),
      ranges_(options.scan_bins),
      ahead_ns_(wall_ahead_now()) {
  if (options.packed == packing::zstd) {
    packer_.emplace();
    packed_.resize(mcap::packed_bound(std::size_t{1} << 20U));
  }
  counts_.files = 1;
}

// ---- what is recorded ---------------------------------------------------------------------------

template <class Work>
result<void> recording_writer::file_writer::guarded(Work work) noexcept {
  if (is_closed_) return {};
  try {
    auto done = work();
    tell(done);
    return done;
  } catch (const std::bad_alloc&) {
    result<void> failed = failure(task::writing, problem::system, path(), ENOMEM);
    lose_chunk();
    tell(failed);
    return failed;
  }
}

void recording_writer::file_writer::tell(const result<void>& done) noexcept {
  if (!done && !std::exchange(is_in_trouble_, true)) trouble_ = done.error();
}

std::optional<error> recording_writer::file_writer::take_error() noexcept {
  return std::exchange(trouble_, std::nullopt);
}

/// One message of about `size` bytes, which `put` writes.
template <class Put>
void recording_writer::file_writer::put(topic id, std::int64_t time_ns, std::size_t size,
                                        Put put) noexcept {
  last_ns_ = std::max(last_ns_, time_ns);
  static_cast<void>(guarded([&]() -> result<void> {
    result<void> ended;
    if (!chunk_.is_empty() && (is_due(time_ns) || !chunk_.has_room_for(size + message_room))) {
      ended = end_chunk();
    }
    if (chunk_.is_empty()) begin_chunk(time_ns);
    std::uint32_t& sequence = sequences_[mcap::open_chunk::index_of(id)];
    chunk_last_ns_ = std::max(chunk_last_ns_, time_ns);
    chunk_.begin_message(id, sequence++, time_ns + ahead_ns_);
    put(chunk_.text());
    chunk_.end_message();
    return ended;
  }));
}

bool recording_writer::file_writer::is_due(std::int64_t time_ns) const noexcept {
  return time_ns - chunk_ns_ >= ns_of(options_.chunk_time);
}

void recording_writer::file_writer::line_bytes(direction way, bytes data,
                                               std::int64_t time_ns) noexcept {
  if (is_closed_) return;
  payload_.add(way, data);
  const bool is_from_device = way == direction::from_device;
  (is_from_device ? counts_.bytes_from_device : counts_.bytes_to_device) += data.size();
  while (!data.empty()) {
    const bytes piece = data.first(std::min(data.size(), largest_piece));
    data = data.subspan(piece.size());
    if (is_from_device) ++counts_.readings;
    put(is_from_device ? topic::from_device : topic::to_device, time_ns, piece.size(),
        [&](mcap::record_text& out) {
          mcap::put_line_bytes(out, piece, time_ns);
          chunk_payload_.add(way, piece);
          chunk_bytes_ += piece.size();
        });
  }
}

void recording_writer::file_writer::note(const line_note& what) noexcept {
  if (what.what == line_note::kind::sent) {
    return line_bytes(direction::to_device, what.data, what.time_ns);
  }
  if (what.what != line_note::kind::state) {  // each chunk begins with one, of what was before
    put(topic::notes, what.time_ns, 0,
        [&](mcap::record_text& out) { mcap::put_note(out, what, ahead_ns_); });
  }
  line_.take(what);
}

void recording_writer::file_writer::scan(const g4lidar::scan& revolution) noexcept {
  if (is_closed_ || revolution.points.empty()) return;
  ++counts_.scans;
  fill_grid(revolution.points, ranges_, {.to = frame::robot});
  const std::int64_t first_ns = revolution.points.front().time_ns;
  put(topic::scan, last_ns_, ranges_.size() * sizeof(float), [&](mcap::record_text& out) {
    mcap::put_scan(out, ranges_, first_ns + ahead_ns_, revolution.duration_ns, options_.frame_id);
  });
}

void recording_writer::file_writer::device(const recorded_device& known) noexcept {
  static_cast<void>(guarded([&]() -> result<void> {
    device_ = known;
    if (!chunk_.is_empty()) {
      if (auto ended = end_chunk(); !ended) return ended;
    }
    return file_->add_metadata(mcap::device_metadata, mcap::words_of(known));
  }));
}

void recording_writer::file_writer::set_wall_clock(std::int64_t ahead_ns) noexcept {
  is_ahead_given_ = true;
  ahead_ns_ = ahead_ns;
}

// ---- chunks and files ---------------------------------------------------------------------------

/// Each begins with what a reader needs that knows nothing of those before it.
void recording_writer::file_writer::begin_chunk(std::int64_t time_ns) {
  if (!is_ahead_given_) ahead_ns_ = wall_ahead_now();
  if (!file_->has_chunks()) file_ns_ = time_ns;
  chunk_ns_ = chunk_last_ns_ = time_ns;
  chunk_bytes_ = 0;
  chunk_.put_channels(options_.topic);
  if (!line_.is_known) return;
  chunk_.begin_message(topic::notes, sequences_[mcap::open_chunk::index_of(topic::notes)]++,
                       time_ns + ahead_ns_);
  mcap::put_note(chunk_.text(), line_.as_note(time_ns), ahead_ns_);
  chunk_.end_message();
}

result<bytes> recording_writer::file_writer::pack() {
  if (!packer_) return bytes{};
  const bytes records = chunk_.records();
  packed_.resize(std::max(packed_.size(), mcap::packed_bound(records.size())));
  const std::size_t size = packer_->pack(records, packed_);
  if (size == 0) return failure(task::writing, problem::system, path(), ENOMEM);
  return bytes(packed_).first(size);
}

/// The chunk goes to the file, or is lost; empty it is in any case.
result<void> recording_writer::file_writer::end_chunk() {
  if (chunk_.is_empty()) return {};
  const auto packed = pack();
  result<void> rotated;
  if (packed) {
    const std::uint64_t after = file_->closed_size() + 2 * chunk_.records().size();
    const bool is_full = options_.rotate_bytes != 0 && after > options_.rotate_bytes;
    const std::int64_t rotate_ns = ns_of(options_.rotate_time);
    const bool is_old = rotate_ns != 0 && chunk_last_ns_ - file_ns_ >= rotate_ns;
    if (file_->has_chunks() && (is_full || is_old)) rotated = rotate();
  }
  result<void> added = packed ? file_->add(chunk_, *packed) : tl::unexpected(packed.error());
  if (!added) {
    lose_chunk();
    return added;
  }
  chunk_.clear();
  ++counts_.chunks;
  file_payload_ = chunk_payload_;
  file_last_ns_ = chunk_last_ns_;
  if (rotated) is_in_trouble_ = false;
  return rotated;
}

void recording_writer::file_writer::lose_chunk() noexcept {
  chunk_.clear();
  ++counts_.chunks_lost;
  counts_.bytes_lost += std::exchange(chunk_bytes_, 0);
  chunk_payload_ = file_payload_;  // it tells of what is in the file
}

/// The new file is made first: where that fails, the old one goes on.
result<void> recording_writer::file_writer::rotate() {
  auto next = mcap::mcap_file::create(next_path(), options_.topic, options_.overwrite);
  if (!next) return tl::unexpected(next.error());
  auto ended = end_file(false);
  ++counts_.files;
  closed_bytes_ += file_->size();
  file_ = std::make_unique<mcap::mcap_file>(std::move(*next));
  file_ns_ = chunk_ns_;
  chunk_payload_ = payload_of(chunk_.records());
  if (ended && device_)
    ended = file_->add_metadata(mcap::device_metadata, mcap::words_of(*device_));
  return ended;
}

std::string recording_writer::file_writer::next_path() const {
  constexpr std::string_view extension = ".mcap";
  std::string_view stem = first_path_;
  const bool has_extension = stem.ends_with(extension);
  if (has_extension) stem.remove_suffix(extension.size());
  std::array<char, 16> number{};
  std::snprintf(number.data(), number.size(), "-%04llu",
                static_cast<unsigned long long>(counts_.files));
  return std::string(stem) + number.data() + (has_extension ? std::string(extension) : "");
}

result<void> recording_writer::file_writer::end_file(bool is_only_one) {
  mcap::word_map words{{"payload", hexadecimal(file_payload_.value())},
                       {"first_ns", std::to_string(file_ns_)},
                       {"last_ns", std::to_string(file_last_ns_)}};
  if (is_only_one && points_.count() > 0) {  // they go on from file to file
    words.emplace_back("points", hexadecimal(points_.value()));
    words.emplace_back("point_count", std::to_string(points_.count()));
    words.emplace_back("computed_with", computed_with());
  }
  auto kept = file_->add_metadata(mcap::digest_metadata, words);
  auto closed = file_->close();
  return kept ? closed : kept;
}

result<void> recording_writer::file_writer::flush() noexcept {
  return guarded([&] { return end_chunk(); });
}

result<void> recording_writer::file_writer::close() noexcept {
  auto done = guarded([&]() -> result<void> {
    auto ended = end_chunk();
    auto closed = end_file(counts_.files == 1);
    return ended ? closed : ended;
  });
  is_closed_ = true;
  return done;
}

recording_counts recording_writer::file_writer::counts() const noexcept {
  recording_counts all = counts_;
  all.file_bytes = closed_bytes_ + file_->size();
  return all;
}

recorded_digest recording_writer::file_writer::digest() const noexcept {
  return {payload_.value(), points_.count() > 0 ? points_.value() : 0, points_.count(), true};
}

// ---- recording_writer ---------------------------------------------------------------------------

recording_writer::recording_writer(std::unique_ptr<file_writer> made) noexcept
    : made_(std::move(made)) {}
recording_writer::recording_writer(recording_writer&&) noexcept = default;
recording_writer& recording_writer::operator=(recording_writer&& other) noexcept {
  if (made_ != nullptr && this != &other) static_cast<void>(close());
  made_ = std::move(other.made_);
  return *this;
}
recording_writer::~recording_writer() {
  if (made_ != nullptr) static_cast<void>(close());
}

result<recording_writer> recording_writer::create(std::string_view path,
                                                  const recording_options& options) {
  if (const auto wrong = problem_with(options)) return tl::unexpected(*wrong);
  auto first = mcap::mcap_file::create(std::string(path), options.topic, options.overwrite);
  if (!first) return tl::unexpected(first.error());
  return recording_writer(std::make_unique<file_writer>(std::move(*first), path, options));
}

void recording_writer::from_device(bytes data, std::int64_t time_ns) noexcept {
  made_->line_bytes(direction::from_device, data, time_ns);
}
void recording_writer::to_device(bytes data, std::int64_t time_ns) noexcept {
  made_->line_bytes(direction::to_device, data, time_ns);
}
void recording_writer::note(const line_note& what) noexcept { made_->note(what); }
void recording_writer::scan(const g4lidar::scan& revolution) noexcept { made_->scan(revolution); }
void recording_writer::points(std::span<const point> delivered) noexcept {
  made_->points(delivered);
}
void recording_writer::device(const recorded_device& known) noexcept { made_->device(known); }
void recording_writer::set_wall_clock(std::int64_t ahead_ns) noexcept {
  made_->set_wall_clock(ahead_ns);
}
result<void> recording_writer::flush() noexcept { return made_->flush(); }
result<void> recording_writer::close() noexcept { return made_->close(); }
std::optional<error> recording_writer::take_error() noexcept { return made_->take_error(); }
recording_counts recording_writer::counts() const noexcept { return made_->counts(); }
recorded_digest recording_writer::digest() const noexcept { return made_->digest(); }
std::string_view recording_writer::path() const noexcept { return made_->path(); }

}  // namespace g4lidar
