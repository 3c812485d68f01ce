// SPDX-License-Identifier: MIT
// Output to a file that appears complete or not at all; or directly to standard output, a pipe or a device.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "command_files.hpp"
#include "text_sink.hpp"

namespace g4_tool {

/// Its name in messages.
[[nodiscard]] std::string title_of_output(const std::string& name);

/// A buffered output. A file on disk is written beside its place under a temporary name, and commit()
/// renames it; without commit(), and if it could not be written, it is removed and an older file of that name remains.
/// All else is written directly. It is a claimed_output.
class output : public text_sink {
 public:
  /// When a file on disk appears under its name.
  enum class appears : unsigned char {
    whole,    ///< At commit().
    growing,  ///< With the first bytes, so that they remain after a crash.
  };

  /// The file of that name; standard output for `-` and `/dev/stdout`.
  explicit output(std::string name, appears when = appears::whole);
  output(const output&) = delete;
  output& operator=(const output&) = delete;
  ~output() override;

  /// Calls flush(), then overwrites the beginning of the output. For a file on disk.
  void replace_begin(std::string_view text);
  /// Calls flush() and gives the file its name. Does nothing after a failure of this output.
  void commit();

  /// The reader has closed the pipe: further output is discarded. That is a normal end.
  [[nodiscard]] bool is_closed() const noexcept { return closed_; }
  /// The caller has seen that the reader has closed it.
  void close_early() noexcept { closed_ = true; }

  [[nodiscard]] bool is_terminal() const noexcept;
  [[nodiscard]] int descriptor() const noexcept { return fd_; }
  /// The path of the file until commit().
  [[nodiscard]] const std::string& place() const noexcept {
    return temporary_.empty() ? name_ : temporary_;
  }
  /// Its name in messages.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  void take(std::string_view text) override;
  void open_beside(const struct stat* older);
  [[noreturn]] void fail(const char* doing, int error);

  std::string name_;
  std::string title_;
  claimed_output claim_;
  std::string temporary_;  // until commit()
  int fd_ = 1;             // -1: a growing file before its first bytes
  bool closed_ = false;
  bool has_failed_ = false;
};

/// The names of numbered files.
using numbered_files = std::function<std::string(std::uint64_t)>;

/// For `scan-%04d.pcd` or a directory; empty if `name` is the name of one file. Throws a bad_value for
/// other uses of %.
[[nodiscard]] numbered_files numbered_files_of(const std::string& name);

/// The advice for an error of writing.
[[nodiscard]] const char* advice_on_writing(int error) noexcept;

}  // namespace g4_tool
