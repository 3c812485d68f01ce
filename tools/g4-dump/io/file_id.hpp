// SPDX-License-Identifier: MIT
// Which file on disk lies behind a name or a descriptor.
#pragma once

#include <sys/stat.h>

#include <optional>
#include <string>

namespace g4_dump {

/// A regular file, whatever name it has.
struct file_id {
  dev_t device;
  ino_t number;

  friend bool operator==(const file_id&, const file_id&) = default;
};

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

/// `name` as it stands in sentences.
[[nodiscard]] inline std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

}  // namespace g4_dump
