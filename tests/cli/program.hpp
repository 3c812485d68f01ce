// SPDX-License-Identifier: MIT
// g4-dump as a person runs it: started with arguments, fed, listened to, and waited for.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cli {

/// Where a standard stream of the program leads.
struct stream {
  enum class kind { pipe, file, closed, descriptor } to = kind::pipe;
  std::string file;
  int descriptor = -1;

  static stream of_file(std::string name) { return {kind::file, std::move(name), -1}; }
  static stream of(int descriptor) { return {kind::descriptor, {}, descriptor}; }
  static stream none() { return {kind::closed, {}, -1}; }
};

struct streams {
  stream in;
  stream out;
  stream err;
};

/// How the program ended, and what it wrote.
struct outcome {
  int code = -1;   ///< The exit code; -1 if a signal ended it.
  int signal = 0;  ///< That signal.
  std::string out;
  std::string err;
  long max_rss_kib = 0;  ///< The most memory it had.
};

/// The program while it runs. Terminated if nobody waits for it. With VALGRIND in the environment under valgrind: its exit
/// code is 9 after an error.
class program {
 public:
  explicit program(const std::vector<std::string>& arguments, const streams& leading = {});
  program(const program&) = delete;
  program& operator=(const program&) = delete;
  ~program();

  /// Writes to its standard input, as much as it takes without an end of its reading.
  void feed(std::string_view data);
  void close_input();
  /// Nobody will ever read its standard input again.
  [[nodiscard]] bool input_is_dead() const;
  /// It has read all that it was fed.
  [[nodiscard]] bool has_read_its_input() const;
  /// Nobody reads its standard output any more.
  void close_output();
  void send(int signal) const;
  /// It has begun to handle this signal.
  [[nodiscard]] bool handles(int signal) const;
  /// Reads its standard output until `text` is there; all that was read, or fails after `patience`.
  std::string read_until(std::string_view text);
  /// Closes its input, reads everything and waits for the end; fails after 210 seconds.
  outcome wait();

 private:
  bool read_some(int timeout_ms);

  pid_t pid_ = -1;
  int in_ = -1;
  int out_ = -1;
  int err_ = -1;
  outcome so_far_;
};

/// Runs it to its end, `input` on its standard input.
[[nodiscard]] outcome run(const std::vector<std::string>& arguments, std::string_view input = {});

/// The same where files have at most so many bytes.
[[nodiscard]] outcome run_on_full_disk(std::uint64_t bytes,
                                       const std::vector<std::string>& arguments);

/// A directory of its own for each test, gone behind it.
class scratch : public ::testing::Test {
 protected:
  scratch();
  ~scratch() override;
  [[nodiscard]] std::string path(std::string_view name) const { return directory_ / name; }
  /// The names of all files there, sorted, one a line.
  [[nodiscard]] std::string listing() const;

  std::filesystem::path directory_;
};

/// The same, as the current directory: names of files need no path.
class scratch_here : public scratch {
 protected:
  scratch_here() { std::filesystem::current_path(directory_); }
  ~scratch_here() override { std::filesystem::current_path(before_); }

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

[[nodiscard]] std::string read_file(const std::string& name);
void write_file(const std::string& name, std::string_view text);
/// `block`, again and again, until the file has at least `size` bytes.
void write_repeated(const std::string& name, std::string_view block, std::uint64_t size);

[[nodiscard]] std::vector<std::string> lines_of(const std::string& text);

}  // namespace cli
