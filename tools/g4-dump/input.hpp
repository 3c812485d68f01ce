// SPDX-License-Identifier: MIT
// Bytes from a file, a pipe or standard input, as they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "file_id.hpp"

namespace g4_dump {

/// Something that is read from its beginning to its end. Closes itself.
class input {
 public:
  /// The file of that name, `-` for standard input. `what_to_give` ends the sentence of a failure:
  /// "Give a file with ...".
  input(const std::string& name, const std::string& what_to_give);
  input(const input&) = delete;
  input& operator=(const input&) = delete;
  ~input();

  /// Reads what is there, waiting until something is; how many bytes, 0 at the end or after a signal.
  [[nodiscard]] std::size_t read(std::span<std::uint8_t> into);

  /// Whether read() would have to wait now. Files on disk never wait.
  [[nodiscard]] bool would_wait() const noexcept;

  /// Where it is a file on disk: which one, and how long it is now.
  [[nodiscard]] const std::optional<file_id>& id() const noexcept { return id_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

  [[nodiscard]] int descriptor() const noexcept { return fd_; }
  /// As it stands in sentences.
  [[nodiscard]] const std::string& title() const noexcept { return title_; }

 private:
  int fd_ = 0;
  std::string title_;
  std::optional<file_id> id_;
  std::uint64_t size_ = 0;
};

}  // namespace g4_dump
