// SPDX-License-Identifier: MIT
// Opening and reading, with every failure as a sentence.
#include "input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "progress.hpp"

namespace g4_dump {
namespace {

std::string advice_on(int error, const std::string& what_to_give) {
  if (error == ENOENT || error == ENOTDIR) return "Check the name. " + what_to_give;
  if (error == EACCES || error == EPERM) return "You need the permission to read it.";
  return what_to_give;
}

/// A recording comes in files; in a pipe it would be taken for noise.
void refuse_recording(std::span<const std::uint8_t> begin, const std::string& title) {
  constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  if (!std::ranges::equal(begin.first(std::min(begin.size(), magic.size())), magic)) return;
  throw failure(exit_code::bad_file,
                title +
                    " is a recording, not raw bytes. Give the file's name to g4-dump dump, scan "
                    "or packets; a recording is not read from a pipe.");
}

}  // namespace

input::input(const std::string& name, const std::string& what_to_give) {
  if (name == "-") {
    title_ = "standard input";
    if (::isatty(0) != 0) {
      throw failure(exit_code::usage, "standard input is a terminal. " + what_to_give);
    }
  } else {
    title_ = in_quotes(name);
    fd_ = open_file(name, O_RDONLY);
    if (fd_ < 0) {
      throw failure(exit_code::bad_file,
                    fmt::format("cannot open {}: {}. {}", title_, std::strerror(errno),
                                advice_on(errno, what_to_give)));
    }
  }
  struct stat status{};
  if (::fstat(fd_, &status) != 0) return;
  if (S_ISDIR(status.st_mode)) {
    if (fd_ != 0) ::close(fd_);
    throw failure(exit_code::bad_file, title_ + " is a directory. " + what_to_give);
  }
  id_ = id_of(status);
  if (id_) size_ = static_cast<std::uint64_t>(status.st_size);
}

input::~input() {
  if (fd_ != 0) ::close(fd_);
}

std::size_t input::read(std::span<std::uint8_t> into) {
  while (interrupt() == 0) {
    const ssize_t count = ::read(fd_, into.data(), into.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EIO && ::isatty(fd_) != 0) return 0;  // the other side of a terminal has gone
    if (errno == EAGAIN && wait_for_input(fd_, -1) == wake::input) continue;
    if (errno == EINTR || errno == EAGAIN) continue;
    throw failure(exit_code::bad_file,
                  fmt::format("cannot read {}: {}. Check the disk or the device it lies on, or "
                              "make a copy of it and give that.",
                              title_, std::strerror(errno)));
  }
  return 0;
}

bool input::wait(output& out, const time_limits& limits) const {
  pollfd waiting{fd_, POLLIN, 0};
  if (id_ || ::poll(&waiting, 1, 0) != 0) return true;
  out.flush();
  return !out.is_closed() && wait_for_input(fd_, out.descriptor(), limits.end()) == wake::input;
}

void input::pump(output& out, const byte_sink& sink, const common_options& options) {
  constexpr std::size_t first_piece = 16'384;
  progress_bar bar(size_, sink.with_bar && !out.is_terminal());
  std::vector<std::uint8_t> buffer(std::size_t{256} * 1024);
  time_limits limits(options.duration, options.idle);
  std::uint64_t bytes = 0;
  while (!out.is_closed() && !(sink.is_done && sink.is_done())) {
    if (!wait(out, limits) || (!id_ && limits.is_over())) return;
    const std::size_t most = bytes == 0 ? first_piece : buffer.size();
    const std::span<const std::uint8_t> got(buffer.data(), read(std::span(buffer).first(most)));
    if (got.empty()) return;
    limits.came();
    if (bytes == 0) refuse_recording(got, title_);
    sink.take(got);
    if (bytes == 0) out.flush();
    bytes += got.size();
    bar.show(bytes);
  }
}

g4lidar::recording_reader read_items(
    const std::string& path, const g4lidar::reading_options& range,
    const std::function<bool(const g4lidar::recorded_item&)>& take) {
  auto reader = g4lidar::recording_reader::open(path, range);
  if (!reader) throw failure(reader.error());
  progress_bar bar(reader->size());
  while (interrupt() == 0) {
    const auto got = reader->next();
    if (!got) throw failure(got.error());
    const auto& item = *got;
    if (!item || !take(*item)) break;
    bar.show(reader->position());
  }
  return *std::move(reader);
}

std::string describe(const g4lidar::recording_damage& damage) {
  if (!damage.any()) return {};
  return fmt::format("{}{} of the file skipped, {} damaged\n",
                     damage.is_cut_off ? "the file was cut off, " : "",
                     counted(damage.bytes_skipped, "byte"), counted(damage.chunks_lost, "chunk"));
}

}  // namespace g4_dump
