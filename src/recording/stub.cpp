// SPDX-License-Identifier: MIT
// Stands in until the rest is there.
#include <fcntl.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "g4lidar/recording.hpp"
#include "g4lidar/recording_reader.hpp"
#include "g4lidar/replay.hpp"

namespace g4lidar {
class recording_writer::file_writer {};
class recording_reader::file_reader {};
bool has_zstd() noexcept { return false; }
std::string_view computed_with() noexcept { return "nothing"; }
std::string_view name_of(line_note::kind) noexcept { return "note"; }
recording_writer::recording_writer(std::unique_ptr<file_writer> made) noexcept
    : made_(std::move(made)) {}
recording_writer::recording_writer(recording_writer&&) noexcept = default;
recording_writer& recording_writer::operator=(recording_writer&&) noexcept = default;
recording_writer::~recording_writer() = default;
result<recording_writer> recording_writer::create(std::string_view path, const recording_options&) {
  return failure(task::opening, problem::system, path, ENOSYS);
}
void recording_writer::from_device(bytes, std::int64_t) noexcept {}
void recording_writer::to_device(bytes, std::int64_t) noexcept {}
void recording_writer::note(const line_note&) noexcept {}
void recording_writer::scan(const g4lidar::scan&) noexcept {}
void recording_writer::points(std::span<const point>) noexcept {}
void recording_writer::device(const recorded_device&) {}
void recording_writer::set_wall_clock(std::int64_t) noexcept {}
result<void> recording_writer::flush() noexcept { return {}; }
result<void> recording_writer::close() noexcept { return {}; }
std::optional<error> recording_writer::take_error() noexcept { return std::nullopt; }
recording_counts recording_writer::counts() const noexcept { return {}; }
recorded_digest recording_writer::digest() const noexcept { return {}; }
std::string_view recording_writer::path() const noexcept { return {}; }
result<std::unique_ptr<connector>> recorded(std::unique_ptr<connector> line, recording_writer&) {
  return line;
}
bool is_recording(std::string_view path) noexcept {
  const int fd = ::open(std::string(path).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  std::array<char, 8> begin{};
  const bool good = fd >= 0 && ::read(fd, begin.data(), 8) == 8 &&
                    std::memcmp(begin.data(), "\x89MCAP0\r\n", 8) == 0;
  if (fd >= 0) ::close(fd);
  return good;
}
recording_reader::recording_reader(std::unique_ptr<file_reader> made) noexcept
    : made_(std::move(made)) {}
recording_reader::recording_reader(recording_reader&&) noexcept = default;
recording_reader& recording_reader::operator=(recording_reader&&) noexcept = default;
recording_reader::~recording_reader() = default;
result<recording_reader> recording_reader::open(std::string_view path, const reading_options&) {
  return failure(task::opening, problem::bad_file, path);
}
result<std::optional<recorded_item>> recording_reader::next() noexcept { return std::nullopt; }
const std::optional<recorded_device>& recording_reader::device() const noexcept {
  static const std::optional<recorded_device> none;
  return none;
}
const std::optional<recorded_digest>& recording_reader::digest() const noexcept {
  static const std::optional<recorded_digest> none;
  return none;
}
std::int64_t recording_reader::first_ns() const noexcept { return 0; }
std::int64_t recording_reader::last_ns() const noexcept { return 0; }
const recording_damage& recording_reader::damage() const noexcept {
  static const recording_damage none;
  return none;
}
std::uint64_t recording_reader::position() const noexcept { return 0; }
std::uint64_t recording_reader::size() const noexcept { return 0; }
result<std::unique_ptr<connector>> replay::open(std::string_view path, const replay_options&) {
  return failure(task::opening, problem::bad_file, path);
}
}  // namespace g4lidar
