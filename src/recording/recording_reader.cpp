// SPDX-License-Identifier: MIT
// The public interface of the reader.
#include "g4lidar/recording/reader.hpp"

#include <new>
#include <utility>

#include "recording/mcap/file_reader.hpp"

namespace g4lidar {

bool is_recording(std::string_view path) noexcept {
  try {
    const auto file = mcap::open_file_source(path);
    return file && mcap::has_magic(**file);
  } catch (const std::bad_alloc&) {
    return false;
  }
}

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

const model& recording_access::begun_as(const recording_reader& of) noexcept {
  return of.made_ ? of.made_->begun_as() : g4_model;
}

result<recording_reader> recording_access::open(std::shared_ptr<mcap::byte_source> file,
                                                std::string_view path,
                                                const reading_options& options) {
  auto made = recording_reader::file_reader::open(std::move(file), path, options);
  if (!made) return tl::unexpected(made.error());
  return recording_reader(std::move(*made));
}

// A moved-from reader behaves as at the end of an empty file.

result<std::optional<recorded_item>> recording_reader::next() noexcept {
  if (!made_) return std::optional<recorded_item>();
  return made_->next();
}
const std::optional<recorded_device>& recording_reader::device() const noexcept {
  static constexpr std::optional<recorded_device> none;
  return made_ ? made_->device() : none;
}
const std::optional<recorded_digest>& recording_reader::digest() const noexcept {
  static constexpr std::optional<recorded_digest> none;
  return made_ ? made_->digest() : none;
}
const model& recording_reader::model() const noexcept { return made_ ? made_->model() : g4_model; }
std::int64_t recording_reader::first_ns() const noexcept { return made_ ? made_->first_ns() : 0; }
std::int64_t recording_reader::last_ns() const noexcept { return made_ ? made_->last_ns() : 0; }
const recording_damage& recording_reader::damage() const noexcept {
  static constexpr recording_damage none;
  return made_ ? made_->damage() : none;
}
std::uint64_t recording_reader::position() const noexcept { return made_ ? made_->position() : 0; }
std::uint64_t recording_reader::size() const noexcept { return made_ ? made_->size() : 0; }

}  // namespace g4lidar
