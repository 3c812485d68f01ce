// SPDX-License-Identifier: MIT
#include "new_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "transport/system_calls.hpp"

namespace g4lidar {
namespace {

constexpr unsigned permissions = 0777;

owned_fd open_to_write(const std::string& path, int flags) noexcept {
  constexpr int always = O_RDWR | O_CLOEXEC | O_NOCTTY;
  return owned_fd(uninterrupted([&] { return ::open(path.c_str(), flags | always, 0666); }));
}

tl::unexpected<error> failed(task doing, const std::string& path) {
  return failure(doing, problem::system, path, errno);
}

}  // namespace

result<new_file> new_file::create(const std::string& path, bool replaces) {
  struct stat older{};
  const bool is_there = ::stat(path.c_str(), &older) == 0;
  const bool is_file = is_there && S_ISREG(older.st_mode);
  if (is_file && replaces) return create_beside(path, older.st_mode & permissions);
  // A device is written to as it is. So is a pipe, where writing then fails: ESPIPE.
  const bool exists = is_there && !is_file;
  owned_fd fd = open_to_write(path, exists ? 0 : O_CREAT | (replaces ? O_TRUNC : O_EXCL));
  if (!fd) return failed(task::opening, path);
  return new_file(std::move(fd), path);
}

result<new_file> new_file::create_beside(const std::string& path, unsigned mode) {
  if (::access(path.c_str(), W_OK) != 0) return failed(task::opening, path);
  std::error_code why;
  const std::filesystem::path target = std::filesystem::canonical(path, why);
  if (why) return failure(task::opening, problem::system, path, why.value());
  const std::string begin = target.parent_path() / (".g4lidar-" + std::to_string(::getpid()) + "-");
  // All memory is taken before there is a file, which would be left behind.
  std::string name = path;
  std::string place = target.string();
  for (unsigned attempt = 0;; ++attempt) {
    std::string temporary = begin + std::to_string(attempt) + ".tmp";
    owned_fd fd = open_to_write(temporary, O_CREAT | O_EXCL);
    if (!fd && errno == EEXIST) continue;
    if (!fd) return failed(task::opening, path);
    static_cast<void>(::fchmod(fd.get(), mode));
    new_file made(std::move(fd), std::move(name));
    made.temporary_ = std::move(temporary);
    made.target_ = std::move(place);
    return made;
  }
}

result<void> new_file::take_place() noexcept {
  if (temporary_.empty() || !is_kept_ || !fd_) return {};
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return failed(task::writing, path_);
  temporary_.clear();
  return {};
}

void new_file::drop_if_waiting() noexcept {
  if (!temporary_.empty() && fd_) ::unlink(temporary_.c_str());
  temporary_.clear();
}

void new_file::remove() noexcept {
  drop_if_waiting();
  const std::string& place = target_.empty() ? path_ : target_;
  struct stat mine{};
  struct stat there{};
  const bool is_there = fd_ && ::fstat(fd_.get(), &mine) == 0 && S_ISREG(mine.st_mode) &&
                        ::stat(place.c_str(), &there) == 0;
  if (is_there && mine.st_dev == there.st_dev && mine.st_ino == there.st_ino)
    ::unlink(place.c_str());
}

bool are_one_file(const std::string& one, const std::string& other) noexcept {
  struct stat first{};
  struct stat second{};
  return ::stat(one.c_str(), &first) == 0 && ::stat(other.c_str(), &second) == 0 &&
         S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

}  // namespace g4lidar
