// SPDX-License-Identifier: MIT
// A file that is made, and the older file of its name.
#pragma once

#include <string>
#include <utility>

#include "g4lidar/error.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar {

/// If it is to replace a file, it is written beside it, under a temporary name, until take_place(): until then the
/// older file remains.
class new_file {
 public:
  /// `replaces`: an existing regular file may be replaced. Else it is an error: EEXIST. A device is opened as it is.
  [[nodiscard]] static result<new_file> create(const std::string& path, bool replaces);
  new_file(new_file&&) noexcept = default;
  new_file& operator=(new_file&&) = delete;
  /// Without take_place() an older file remains, and nothing of this one.
  ~new_file() { drop_if_waiting(); }

  [[nodiscard]] int fd() const noexcept { return fd_.get(); }
  /// Where it is, or is to be.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// It is worth to replace an older one. Without that take_place() does nothing.
  void keep() noexcept { is_kept_ = true; }
  [[nodiscard]] bool is_kept() const noexcept { return is_kept_; }
  /// Replaces the older file, if there is one and it has not been replaced.
  [[nodiscard]] result<void> take_place() noexcept;
  /// Removes it if it has not replaced the older file.
  void drop_if_waiting() noexcept;
  /// Removes it. A device stays, and so does what somebody else has put in its place.
  void remove() noexcept;

 private:
  new_file(owned_fd fd, std::string path) noexcept : fd_(std::move(fd)), path_(std::move(path)) {}
  [[nodiscard]] static result<new_file> create_beside(const std::string& path, unsigned mode);

  owned_fd fd_;
  std::string path_;
  std::string temporary_{};  // its path until take_place(); empty: it is at its place
  std::string target_{};     // what it replaces: behind symbolic links
  bool is_kept_ = false;
};

/// Whether both names lead to one file on disk, by device and inode.
[[nodiscard]] bool are_one_file(const std::string& one, const std::string& other) noexcept;

}  // namespace g4lidar
