// SPDX-License-Identifier: MIT
#include "logger.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "common_options.hpp"

namespace g4_tool {
namespace {

/// What is too long for a message, such as a word that nobody has typed, is shortened.
std::string shortened(std::string_view text) {
  constexpr std::size_t longest_word = 300;
  constexpr std::size_t enough = 100;
  std::string all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' ', 1), text.size());
    const bool is_long = end > longest_word;
    all.append(text.substr(0, is_long ? enough : end)).append(is_long ? "..." : "");
    text.remove_prefix(end);
  }
  return all;
}

std::string printable_lines(std::string_view text) {
  std::string shown;
  while (true) {
    const std::size_t end = text.find('\n');
    shown += printable(text.substr(0, end));
    if (end == std::string_view::npos) return shown;
    shown += '\n';
    text.remove_prefix(end + 1);
  }
}

}  // namespace

std::string counted(unsigned long long number, std::string_view noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

std::string wrapped(std::string_view words, std::size_t column, std::size_t indent,
                    std::size_t width) {
  std::string text;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (column + 1 + end > width && column > indent) {
      text.append("\n").append(indent, ' ');
      column = indent;
    } else if (!text.empty()) {
      text += ' ';
      ++column;
    }
    text.append(words.substr(0, end));
    column += end;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return text;
}

std::string json_line(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

status_line::status_line(bool wanted)
    : on_(wanted && !our_global_options().quiet && ::isatty(2) != 0) {}

bool status_line::is_due() {
  const clock::time_point now = clock::now();
  if (!on_ || now < next_) return false;
  next_ = now + std::chrono::milliseconds(100);
  return true;
}

void status_line::draw(std::string_view text) {
  drawn_ = true;
  logger::write(fmt::format("\r{}\x1b[K", text));
}

void status_line::clear() {
  if (std::exchange(drawn_, false)) logger::write("\r\x1b[K");
}

double status_line::seconds() const {
  return std::chrono::duration<double>(clock::now() - begin_).count();
}

void progress_bar::show(std::uint64_t done_bytes) {
  if (!line_.is_due()) return;
  constexpr std::uint64_t width = 40;
  const std::uint64_t done = std::min(done_bytes, all_);  // a file may grow while it is read
  const auto filled = static_cast<int>(done * width / all_);
  const double megabytes = static_cast<double>(done) / 1e6;
  line_.draw(fmt::format("[{:#<{}}{:.<{}}] {:3}%  {:.0f} of {:.0f} MB  {:.0f} MB/s", "", filled, "",
                         static_cast<int>(width) - filled, done * 100 / all_, megabytes,
                         static_cast<double>(all_) / 1e6,
                         megabytes / std::max(line_.seconds(), 1e-3)));
}

namespace logger {

void info(std::string_view message) {
  if (!our_global_options().quiet) write(printable_lines(message));
}

void verbose(std::string_view message) {
  if (our_global_options().verbose) write(printable_lines(message));
}

void error(std::string_view sentences, exit_code code, std::string_view problem) {
  const std::string text = shortened(sentences);
  if (!our_global_options().json_errors) {
    return write(fmt::format("{}: {}\n", this_program().name, printable(text)));
  }
  nlohmann::ordered_json line;
  line["error"] = text;
  if (!problem.empty()) line["problem"] = problem;
  line["exit_code"] = static_cast<int>(code);
  write(json_line(line));
}

void write(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t count = ::write(2, text.data(), text.size());
    if (count <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace logger
}  // namespace g4_tool
