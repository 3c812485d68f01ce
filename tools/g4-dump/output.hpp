// SPDX-License-Identifier: MIT
// A file that appears whole or not at all; or standard output, a pipe, a device, as it comes.
#pragma once

#include <cassert>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "file_id.hpp"

namespace g4_dump {

/// Where data goes, through a buffer. A file on disk is written beside its place under another name
/// and put there by commit(); without a commit() nothing is left of it and an older file of that
/// name stays untouched. Everything else is written to directly.
class output {
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
  ~output();

  /// The most that can be asked of room().
  static constexpr std::size_t max_room = 65'536;

  /// A place to write up to `count` characters to; then say how far with wrote().
  [[nodiscard]] char* room(std::size_t count) {
    assert(count <= max_room);
    if (capacity - used_ < count) flush();
    return buffer_.get() + used_;
  }
  void wrote(const char* end) noexcept { used_ = static_cast<std::size_t>(end - buffer_.get()); }

  void write(std::string_view text);

  /// Hands on everything that was written so far.
  void flush();

  /// flush(), and the file stands in its place.
  void commit();

  /// Nobody reads any more: what is written is thrown away. That is a normal end.
  [[nodiscard]] bool is_closed() const noexcept { return closed_; }
  /// Somebody else has seen that.
  void close_early() noexcept { closed_ = true; }
  [[nodiscard]] bool has_unwritten() const noexcept { return used_ > 0; }

  [[nodiscard]] bool is_terminal() const noexcept;
  /// The file on disk that is written or replaced, if there is one already.
  [[nodiscard]] const std::optional<file_id>& id() const noexcept { return id_; }
  [[nodiscard]] int descriptor() const noexcept { return fd_; }
  /// As it stands in sentences.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  static constexpr std::size_t capacity = 4 * max_room;

  void open_beside(const struct stat* older);
  void prepare_growing(bool exists);
  void open_growing();
  void open_directly();
  void write_out(const char* data, std::size_t size);
  [[noreturn]] void give_up(const char* doing, int error) const;

  std::string name_;
  std::string title_;
  std::string temporary_;  // until it is renamed
  int fd_ = 1;             // -1: a growing file that has not begun
  std::optional<file_id> id_;
  bool closed_ = false;
  std::size_t used_ = 0;
  std::unique_ptr<char[]> buffer_;
};

/// Refuses, with a sentence, to read and write one and the same file.
void refuse_same_file(const std::optional<file_id>& from, const output& to);

}  // namespace g4_dump
