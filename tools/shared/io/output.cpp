// SPDX-License-Identifier: MIT
#include "output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/option_rows.hpp"
#include "interrupt.hpp"

namespace g4_tool {

std::string title_of_output(const std::string& name) {
  return name == "-" ? "standard output" : in_quotes(name);
}

output::output(std::string name, appears when)
    : name_(name == "/dev/stdout" ? "-" : std::move(name)),
      title_(title_of_output(name_)),
      claim_(name_) {
  if (name_ == "-") return;
  struct stat status{};
  const bool exists = ::stat(name_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    throw failure(exit_code::bad_file,
                  title_ + " is a directory. Give the name of a file to write.");
  }
  if (exists && !S_ISREG(status.st_mode)) {
    fd_ = open_file(name_, O_WRONLY);
    if (fd_ < 0) fail("open", errno);
    return;
  }
  if (when == appears::whole) {
    open_beside(exists ? &status : nullptr);
    return;
  }
  const std::string directory = std::filesystem::path(name_).parent_path().string();
  const std::string place = exists ? name_ : directory.empty() ? "." : directory;
  if (::access(place.c_str(), W_OK) != 0) fail(exists ? "replace" : "create", errno);
  fd_ = -1;
}

output::~output() {
  if (fd_ > 2) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void output::open_beside(const struct stat* older) {
  if (older != nullptr && ::access(name_.c_str(), W_OK) != 0) fail("replace", errno);
  std::error_code unknown;
  // Symbolic links are resolved, so that their target is replaced.
  const std::filesystem::path real = std::filesystem::canonical(name_, unknown);
  if (!unknown) name_ = real;
  const std::filesystem::path directory = std::filesystem::path(name_).parent_path();
  for (int attempt = 0;; ++attempt) {
    temporary_ = directory / fmt::format(".g4-dump-{}-{}.tmp", ::getpid(), attempt);
    fd_ = open_file(temporary_, O_WRONLY | O_CREAT | O_EXCL);
    if (fd_ >= 0) break;
    const int error = errno;
    temporary_.clear();  // the destructor must not remove it
    if (error != EEXIST) fail("create", error);
  }
  if (older != nullptr) ::fchmod(fd_, older->st_mode & 0777);
}

void output::take(std::string_view text) {
  if (fd_ < 0 && !text.empty()) {
    claim_.refuse_inputs();
    fd_ = open_file(name_, O_WRONLY | O_CREAT | O_TRUNC);
    if (fd_ < 0) fail("create", errno);
  }
  while (!text.empty() && !closed_) {
    const ssize_t count = ::write(fd_, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EPIPE) {
      closed_ = true;
    } else if (errno == EAGAIN) {
      pollfd waiting{fd_, POLLOUT, 0};
      ::poll(&waiting, 1, -1);
    } else if (errno != EINTR) {
      fail("write", errno);
    }
  }
}

void output::replace_begin(std::string_view text) {
  flush();
  if (fd_ <= 2 || closed_) return;
  for (off_t at = 0; !text.empty();) {
    const ssize_t count = ::pwrite(fd_, text.data(), text.size(), at);
    if (count < 0 && errno != EINTR) fail("write", errno);
    if (count <= 0) continue;
    text.remove_prefix(static_cast<std::size_t>(count));
    at += count;
  }
}

void output::commit() {
  if (has_failed_) return;
  flush();
  if (fd_ <= 2) return;
  if (::close(std::exchange(fd_, -1)) != 0 && errno != EINTR) fail("write", errno);
  if (temporary_.empty()) return;
  claim_.refuse_inputs();
  if (::rename(temporary_.c_str(), name_.c_str()) != 0) fail("replace", errno);
  temporary_.clear();
}

bool output::is_terminal() const noexcept { return ::isatty(fd_) != 0; }

void output::fail(const char* doing, int error) {
  has_failed_ = true;
  throw failure(exit_code::bad_file, fmt::format("cannot {} {}: {}. {}", doing, title_,
                                                 std::strerror(error), advice_on_writing(error)));
}

const char* advice_on_writing(int error) noexcept {
  const auto is_one_of = [error](auto... known) { return ((error == known) || ...); };
  if (error == EEXIST) return "Give another name, or --force to replace it.";
  if (is_one_of(ENOENT, ENOTDIR)) return "Make its directory first, or give another name.";
  if (is_one_of(EACCES, EPERM, EROFS)) return "Give a place where you may write.";
  if (is_one_of(ENOSPC, EDQUOT, EFBIG)) return "Free some space there, or give another place.";
  return "Give another place.";
}

numbered_files numbered_files_of(const std::string& name) {
  std::error_code unknown;
  if (name.ends_with('/') || std::filesystem::is_directory(name, unknown)) {
    return [place = std::filesystem::path(name)](std::uint64_t number) {
      return (place / fmt::format("scan-{:06}.pcd", number)).string();
    };
  }
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return {};
  const std::size_t end = std::min(name.find_first_not_of("0123456789", percent + 1), name.size());
  const std::string width = name.substr(percent + 1, end - percent - 1);
  const std::string after = name.substr(end);
  const bool has_end = after.starts_with('d') || after.starts_with('u');
  if (!has_end || after.find('%') != std::string::npos ||
      (!width.empty() && width.front() != '0')) {
    throw bad_value(fmt::format("'{}' has no single number such as %d or %04d", name));
  }
  return [before = name.substr(0, percent), digits = width.empty() ? 0 : number_of(width, 0, 20),
          behind = after.substr(1)](std::uint64_t number) {
    return fmt::format("{}{:0{}}{}", before, number, digits, behind);
  };
}

}  // namespace g4_tool
