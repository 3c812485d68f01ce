// SPDX-License-Identifier: MIT
// Writing, with every failure as a sentence; the temporary file and its renaming.
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
#include <utility>

#include "exit_code.hpp"
#include "interrupt.hpp"

namespace g4_dump {
namespace {

const char* advice_on(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "Make its directory first, or give another name.";
    case EACCES:
    case EPERM:
    case EROFS:
      return "Give a place where you may write.";
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "Make room there, or give another place.";
    default:
      return "Give another place.";
  }
}

// Behind symbolic links, so that what they point to is replaced and not the links.
std::filesystem::path behind_links(const std::string& name) {
  std::error_code unknown;
  std::filesystem::path real = std::filesystem::canonical(name, unknown);
  return unknown ? std::filesystem::path(name) : real;
}

}  // namespace

output::output(std::string name, appears when)
    : name_(std::move(name)),
      title_(name_ == "-" ? "standard output" : in_quotes(name_)),
      buffer_(new char[capacity]) {
  struct stat status{};
  if (name_ == "-") {
    if (::fstat(1, &status) == 0) id_ = id_of(status);
    return;
  }
  const bool exists = ::stat(name_.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) {
    throw failure(exit_code::bad_file,
                  title_ + " is a directory. Give the name of a file to write.");
  }
  if (exists && !S_ISREG(status.st_mode)) {
    open_directly();
    return;
  }
  if (exists) id_ = id_of(status);
  if (when == appears::whole) {
    open_beside(exists ? &status : nullptr);
  } else {
    prepare_growing(exists);
  }
}

output::~output() {
  if (fd_ > 2) ::close(fd_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void output::open_directly() {
  while (true) {
    fd_ = ::open(name_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (fd_ >= 0) return;
    if (errno != EINTR) give_up("open", errno);
    if (interrupt() != 0) throw interrupted();
  }
}

void output::prepare_growing(bool exists) {
  const std::filesystem::path place = std::filesystem::path(name_).parent_path();
  const std::string directory = place.empty() ? "." : place.string();
  if (::access(exists ? name_.c_str() : directory.c_str(), W_OK) != 0) {
    give_up(exists ? "replace" : "create", errno);
  }
  fd_ = -1;
}

void output::open_growing() {
  while (true) {
    fd_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOCTTY, 0666);
    if (fd_ >= 0) return;
    if (errno != EINTR) give_up("create", errno);
  }
}

void output::open_beside(const struct stat* older) {
  if (older != nullptr && ::access(name_.c_str(), W_OK) != 0) give_up("replace", errno);
  name_ = behind_links(name_);
  const std::filesystem::path directory = std::filesystem::path(name_).parent_path();
  for (int attempt = 0;; ++attempt) {
    temporary_ = directory / fmt::format(".g4-dump-{}-{}.tmp", ::getpid(), attempt);
    fd_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ >= 0) break;
    const int error = errno;
    temporary_.clear();  // it is somebody else's or not there
    if (error != EEXIST) give_up("create", error);
  }
  if (older != nullptr) ::fchmod(fd_, older->st_mode & 0777);
}

void output::write(std::string_view text) {
  while (!text.empty()) {
    const std::string_view part = text.substr(0, max_room);
    char* const at = room(part.size());
    std::memcpy(at, part.data(), part.size());
    wrote(at + part.size());
    text.remove_prefix(part.size());
  }
}

void output::flush() { write_out(buffer_.get(), std::exchange(used_, 0)); }

void output::write_out(const char* data, std::size_t size) {
  if (fd_ < 0 && size > 0) open_growing();
  while (size > 0 && !closed_) {
    const ssize_t count = ::write(fd_, data, size);
    if (count >= 0) {
      data += count;
      size -= static_cast<std::size_t>(count);
    } else if (errno == EPIPE) {
      closed_ = true;
    } else if (errno == EAGAIN) {
      pollfd waiting{fd_, POLLOUT, 0};
      ::poll(&waiting, 1, -1);
    } else if (errno != EINTR) {
      give_up("write", errno);
    }
  }
}

void output::commit() {
  flush();
  if (fd_ <= 2) return;
  if (::close(std::exchange(fd_, -1)) != 0 && errno != EINTR) give_up("write", errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), name_.c_str()) != 0) give_up("replace", errno);
  temporary_.clear();
}

bool output::is_terminal() const noexcept { return ::isatty(fd_) != 0; }

void output::give_up(const char* doing, int error) const {
  throw failure(exit_code::bad_file, fmt::format("cannot {} {}: {}. {}", doing, title_,
                                                 std::strerror(error), advice_on(error)));
}

void refuse_same_file(const std::optional<file_id>& from, const output& to) {
  if (!from || from != to.id()) return;
  throw failure(exit_code::usage,
                to.title() + " is what is read, too. Give another name after -o.");
}

}  // namespace g4_dump
