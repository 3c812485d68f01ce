// SPDX-License-Identifier: MIT
// A file that appears whole or not at all; or standard output, a pipe, a device, as it comes.
#pragma once

#include <sys/stat.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/export/text_sink.hpp"

namespace g4_tool {

/// A regular file on disk, whatever name it has: its device and its number.
using file_id = std::pair<dev_t, ino_t>;

[[nodiscard]] inline std::optional<file_id> id_of(const struct stat& status) noexcept {
  if (!S_ISREG(status.st_mode)) return std::nullopt;
  return file_id{status.st_dev, status.st_ino};
}

/// The regular file of that name; nothing where there is none.
[[nodiscard]] inline std::optional<file_id> id_of_name(const std::string& name) noexcept {
  struct stat status{};
  if (::stat(name.c_str(), &status) != 0) return std::nullopt;
  return id_of(status);
}

/// Where data goes, through a buffer. A file on disk is written beside its place under another name
/// and put there by commit(); without a commit() nothing is left of it and an older file of that
/// name stays untouched. Everything else is written to directly.
class output : public g4lidar::text_sink {
 public:
  /// When a file on disk stands in its place.
  enum class appears : unsigned char {
    whole,    ///< When it is finished.
    growing,  ///< With the first bytes that go to it, so that a crash leaves what there was.
  };

  /// The file of that name, `-` for standard output.
  explicit output(std::string name, appears when = appears::whole);
  output(const output&) = delete;
  output& operator=(const output&) = delete;
  ~output() override;

  /// flush(), then writes `text` over the begin of what was written. For a file on disk.
  void replace_begin(std::string_view text);
  /// flush(), and the file stands in its place.
  void commit();

  /// Nobody reads any more: what is written is thrown away. That is a normal end.
  [[nodiscard]] bool is_closed() const noexcept { return closed_; }
  /// Somebody else has seen that.
  void close_early() noexcept { closed_ = true; }

  [[nodiscard]] bool is_terminal() const noexcept;
  /// The file on disk that is written or replaced, if there is one already.
  [[nodiscard]] const std::optional<file_id>& id() const noexcept { return id_; }
  [[nodiscard]] int descriptor() const noexcept { return fd_; }
  /// Where the file is written until commit().
  [[nodiscard]] const std::string& place() const noexcept {
    return temporary_.empty() ? name_ : temporary_;
  }
  /// As it stands in sentences.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  void take(std::string_view text) override;
  void open_beside(const struct stat* older);
  [[noreturn]] void give_up(const char* doing, int error) const;

  std::string name_;
  std::string title_;
  std::string temporary_;  // until it is renamed
  int fd_ = 1;             // -1: a growing file that has not begun
  std::optional<file_id> id_;
  bool closed_ = false;
};

/// The name of each file: `scan-%04d.pcd` and a directory stand for one for each number.
using numbered_files = std::function<std::string(std::uint64_t)>;

/// Empty where `name` is the name of one file. Throws a bad_value where it makes no sense. With
/// `keeps_existing` the name of a file that exists is refused.
[[nodiscard]] numbered_files numbered_files_of(const std::string& name,
                                               bool keeps_existing = false);

/// What to do where a file cannot be written.
[[nodiscard]] const char* advice_on_writing(int error) noexcept;

/// Refuses, with a sentence, to replace a file on disk.
void refuse_existing(const std::string& name);

/// Refuses, with a sentence, to read and write one and the same file.
void refuse_same_file(const std::optional<file_id>& from, const output& to);

}  // namespace g4_tool
