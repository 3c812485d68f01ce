// SPDX-License-Identifier: MIT
#include "input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/recording/raw_bytes.hpp"

namespace g4_tool {
namespace {

std::string advice_on(int error, const std::string& what_to_give) {
  if (error == ENOENT || error == ENOTDIR) return "Check the name. " + what_to_give;
  if (error == EACCES || error == EPERM) return "You need permission to read it.";
  return what_to_give;
}

/// A recording can be read from files only; in a pipe it would count as noise.
void refuse_recording(std::span<const std::uint8_t> begin, const std::string& title) {
  if (!begins_recording(begin)) return;
  throw failure(exit_code::bad_file,
                title +
                    " is a recording, not raw bytes. Give the file's name to g4-dump dump, scan "
                    "or packets; a recording is not read from a pipe.");
}

std::string baud_question() {
  return "Was the port read at a wrong baud rate, or are they of another model (--model)?";
}

}  // namespace

failure not_opened(const std::string& title, int error, const std::string& what_to_give) {
  return {exit_code::bad_file,
          error == EISDIR ? title + " is a directory. " + what_to_give
                          : fmt::format("cannot open {}: {}. {}", title, std::strerror(error),
                                        advice_on(error, what_to_give))};
}

input::input(const std::string& name, const std::string& what_to_give) {
  add_input(name);
  if (name == "-") {
    title_ = "standard input";
    if (::isatty(0) != 0) {
      throw failure(exit_code::usage, "standard input is a terminal. " + what_to_give);
    }
  } else {
    title_ = in_quotes(name);
    fd_ = open_file(name, O_RDONLY);
    if (fd_ < 0) throw not_opened(title_, errno, what_to_give);
  }
  struct stat status{};
  if (::fstat(fd_, &status) != 0) return;
  if (S_ISDIR(status.st_mode)) {
    if (fd_ != 0) ::close(fd_);
    throw not_opened(title_, EISDIR, what_to_give);
  }
  is_file_ = S_ISREG(status.st_mode);
  if (is_file_) size_ = static_cast<std::uint64_t>(status.st_size);
}

input::~input() {
  if (fd_ != 0) ::close(fd_);
}

std::size_t input::read(std::span<std::uint8_t> into) {
  while (interrupt() == 0) {
    const ssize_t count = ::read(fd_, into.data(), into.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EIO && ::isatty(fd_) != 0) return 0;  // the other side has closed the terminal
    if (errno == EAGAIN && wait_for_input(fd_, -1) == wake::input) continue;
    if (errno == EINTR || errno == EAGAIN) continue;
    throw failure(exit_code::bad_file,
                  fmt::format("cannot read {}: {}. Check the disk, or copy the file and give "
                              "the copy.",
                              title_, std::strerror(errno)));
  }
  return 0;
}

bool input::wait(output& out, const time_limits& limits) const {
  pollfd waiting{fd_, POLLIN, 0};
  if (is_file_ || ::poll(&waiting, 1, 0) != 0) return true;
  out.flush();
  return !out.is_closed() && wait_for_input(fd_, out.descriptor(), limits.end()) == wake::input;
}

recognised_model input::recognise(const common_options& options) {
  using clock = time_limits::clock;
  const auto now_ns = [] {
    return std::chrono::nanoseconds(clock::now().time_since_epoch()).count();
  };
  stream_head head(now_ns());
  time_limits limits(options.duration, options.idle);
  std::vector<std::uint8_t> buffer(4096);
  while (!head.is_complete(now_ns()) && !limits.is_over() && interrupt() == 0) {
    const clock::time_point due{std::chrono::nanoseconds(head.due_ns())};
    if (wait_for_input(fd_, -1, std::min(limits.end(), due)) != wake::input) continue;
    const std::span<const std::uint8_t> got(buffer.data(), read(buffer));
    if (got.empty()) break;
    limits.restart_idle();
    head.take(got, now_ns());
  }
  if (!head.is_complete(now_ns())) head.finish();
  ahead_.assign(head.held().begin(), head.held().end());
  return head.found();
}

std::string input::first_line(const common_options& options) {
  constexpr std::size_t most = 65'536;
  constexpr std::size_t piece = 4096;
  time_limits limits(options.duration, options.idle);
  for (bool is_at_end = false;;) {
    const std::string_view all(reinterpret_cast<const char*>(ahead_.data()), ahead_.size());
    const std::size_t begin = std::min(all.find_first_not_of("\r\n"), all.size());
    const std::size_t end = std::min(all.find_first_of("\r\n", begin), all.size());
    if (end < all.size() || is_at_end) return std::string(all.substr(begin, end - begin));
    is_at_end = all.size() >= most || limits.is_over() || interrupt() != 0 ||
                (!is_file_ && wait_for_input(fd_, -1, limits.end()) != wake::input);
    if (is_at_end) continue;
    const std::size_t held = all.size();
    ahead_.resize(held + piece);
    const std::size_t count = read(std::span(ahead_).subspan(held));
    ahead_.resize(held + count);
    is_at_end = count == 0;
    limits.restart_idle();
  }
}

void input::pump(output& out, const byte_sink& sink, const common_options& options) {
  constexpr std::size_t first_piece = 16'384;
  progress_bar bar(size_, !out.is_terminal());
  std::vector<std::uint8_t> buffer(std::size_t{256} * 1024);
  time_limits limits(options.duration, options.idle);
  const auto is_done = [&] { return out.is_closed() || (sink.is_done && sink.is_done()); };
  std::uint64_t bytes = 0;
  for (std::span<const std::uint8_t> rest = ahead_; !rest.empty() && !is_done();) {
    const auto piece = rest.first(std::min(rest.size(), first_piece));
    if (bytes == 0) refuse_recording(piece, title_);
    sink.take(piece);
    out.flush();
    bytes += piece.size();
    rest = rest.subspan(piece.size());
  }
  while (!is_done()) {
    if (!wait(out, limits) || (!is_file_ && limits.is_over())) return;
    const std::size_t most = bytes == 0 ? first_piece : buffer.size();
    const std::span<const std::uint8_t> got(buffer.data(), read(std::span(buffer).first(most)));
    if (got.empty()) return;
    limits.restart_idle();
    if (bytes == 0) refuse_recording(got, title_);
    sink.take(got);
    if (bytes == 0) out.flush();
    bytes += got.size();
    bar.show(bytes);
  }
}

recording_reader open_recording(const std::string& path, reading_options range) {
  if (!range.is_cancelled) range.is_cancelled = [] { return interrupt() != 0; };
  auto opened = recording_reader::open(path, range);
  if (!opened && opened.error() == problem::cancelled) throw interrupted();
  return value_of(std::move(opened));
}

recording_reader read_items(const std::string& path, const reading_options& range,
                            const std::function<bool(const recorded_item&)>& take) {
  auto reader = open_recording(path, range);
  progress_bar bar(reader.size());
  const auto read = reader.for_each([&](const recorded_item& item) {
    if (interrupt() != 0 || !take(item)) return false;
    bar.show(reader.position());
    return true;
  });
  if (!read && read.error() != problem::cancelled) throw failure(read.error());
  return reader;
}

std::string describe(const recording_damage& damage) {
  if (!damage.any()) return {};
  return fmt::format("{}{} of the file skipped, {} damaged\n",
                     damage.is_cut_off ? "the file was cut off, " : "",
                     counted(damage.bytes_skipped, "byte"), counted(damage.chunks_lost, "chunk"));
}

std::string stats_in_words(const stream_counts& counts, std::uint64_t bytes) {
  std::string crc;
  if (counts.crc_matches + counts.crc_mismatches > 0) {
    crc = fmt::format("CRC of the revolutions: {} right, {} wrong\n", counts.crc_matches,
                      counts.crc_mismatches);
  }
  return fmt::format(
      "{}: {} ({} suspect) with {}, {}{}{}\n"
      "{} skipped: {} noise, {} bad header, {} bad checksum, {} truncated\n{}",
      counted(bytes, "byte"), counted(counts.packets, "packet"), counts.suspect,
      counted(counts.points, "point"), counted(counts.responses, "response"),
      counts.time_packets > 0 ? ", " + counted(counts.time_packets, "time packet") : "",
      counts.empty_packets > 0 ? ", " + counted(counts.empty_packets, "empty packet") : "",
      counted(counts.skipped_bytes(), "byte"), counts.skipped(skip_reason::noise),
      counts.skipped(skip_reason::bad_header), counts.skipped(skip_reason::bad_checksum),
      counts.skipped(skip_reason::truncated), crc);
}

nlohmann::ordered_json counts_as_json(const stream_counts& counts, std::uint64_t bytes) {
  nlohmann::ordered_json skipped;
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    skipped[name_of(static_cast<skip_reason>(i))] = counts.skipped_by_reason[i];
  }
  return {{"bytes", bytes},
          {"packets", counts.packets},
          {"responses", counts.responses},
          {"points", counts.points},
          {"suspect", counts.suspect},
          {"time_packets", counts.time_packets},
          {"empty_packets", counts.empty_packets},
          {"crc_matches", counts.crc_matches},
          {"crc_mismatches", counts.crc_mismatches},
          {"skipped", skipped}};
}

std::vector<std::uint8_t> beginning_of(const std::string& path) {
  std::vector<std::uint8_t> first(beginning_bytes);
  input in(path, {});
  first.resize(in.is_file() ? in.read(first) : 0);
  return first;
}

failure not_packets(std::string_view found) {
  return {exit_code::bad_file,
          fmt::format("{} Give raw bytes from the lidar's port, or use g4-dump convert for csv and "
                      "jsonl.",
                      found)};
}

failure no_packet_in(const std::string& source, bool is_from_a_time) {
  return {exit_code::bad_file,
          fmt::format("there is no whole packet in {}{} g4-dump packets shows what it holds; or "
                      "give another file.",
                      in_quotes(source), is_from_a_time ? " from that time on." : ".")};
}

failure nothing_to_write(const std::string& title, bool is_of_scans) {
  return {exit_code::bad_file,
          fmt::format("{} has no {} in the time that is wanted. Nothing was written.", title,
                      is_of_scans ? "whole revolution" : "point")};
}

failure without_packets(const stream_counts& counts, std::uint64_t bytes,
                        std::span<const std::uint8_t> beginning, const std::string& title) {
  const auto bad = [](const std::string& why) { return failure(exit_code::bad_file, why); };
  const auto found = diagnosis_of(counts, bytes);
  if (found == diagnosis::bad_file) {
    return bad(title + " is empty. Give raw bytes from the lidar's port while it was scanning.");
  }
  const std::string text =
      fmt::format("no point packet in the {} of {}", counted(bytes, "byte"), title);
  g4lidar::layout_recogniser seen;  // of another model than the one that is named
  seen.take(beginning);
  if (const std::size_t size = seen.sample_bytes(); seen.votes(size) >= g4lidar::certain_packets) {
    return failure(g4lidar::error(g4lidar::task::reading, g4lidar::problem::other_device,
                                  fmt::format("{}, packets with samples of {} bytes", title, size),
                                  0, g4lidar::error_detail::other_samples));
  }
  if (const std::string known = g4lidar::what_is(beginning); !known.empty())
    return not_packets(fmt::format("{}. {}", text, known));
  if (found == diagnosis::unknown_bytes) {
    return bad(fmt::format("{}. {} Give raw bytes from the lidar's port.", text, baud_question()));
  }
  if (2 * counts.skipped(skip_reason::bad_checksum) > bytes) {
    return bad(text +
               ": the checksums do not fit the samples of this model. Give --model, or raw bytes "
               "that are not damaged.");
  }
  return bad(fmt::format("{}, only {}: the lidar was not scanning. Start it, and record again.",
                         text, counts.responses == 1 ? "a response" : "responses"));
}

std::string warning_about(const stream_counts& counts, std::uint64_t bytes,
                          std::span<const std::uint8_t> beginning) {
  if (counts.packets == 0) return {};
  // A healthy lidar sends one byte a revolution that is none of a packet.
  if (1'000 * counts.skipped_bytes() < bytes) return {};
  if (const std::string known = g4lidar::what_is(beginning); !known.empty()) return known + "\n";
  if (diagnosis_of(counts, bytes) != diagnosis::line_noise) return {};
  return "More than half of the bytes belong to no packet. " + baud_question() + "\n";
}

}  // namespace g4_tool
