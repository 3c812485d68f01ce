// SPDX-License-Identifier: MIT
// Opening and reading, with every failure as a sentence.
#include "input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "exit_code.hpp"
#include "interrupt.hpp"

namespace g4_dump {
namespace {

std::string advice_on(int error, const std::string& what_to_give) {
  if (error == ENOENT || error == ENOTDIR) return "Check the name. " + what_to_give;
  if (error == EACCES || error == EPERM) return "You need the permission to read it.";
  return what_to_give;
}

int open_to_read(const std::string& name, const std::string& what_to_give) {
  while (true) {
    const int fd = ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
    if (fd >= 0) return fd;
    if (errno == EINTR) {
      if (interrupt() != 0) throw interrupted();
      continue;
    }
    throw failure(exit_code::bad_file,
                  fmt::format("cannot open {}: {}. {}", in_quotes(name), std::strerror(errno),
                              advice_on(errno, what_to_give)));
  }
}

}  // namespace

input::input(const std::string& name, const std::string& what_to_give) {
  if (name == "-") {
    title_ = "standard input";
    if (::isatty(0) != 0) {
      throw failure(exit_code::usage, "standard input is a terminal. " + what_to_give);
    }
  } else {
    title_ = in_quotes(name);
    fd_ = open_to_read(name, what_to_give);
  }
  struct stat status{};
  if (::fstat(fd_, &status) != 0) return;
  if (S_ISDIR(status.st_mode)) {
    if (fd_ != 0) ::close(fd_);
    throw failure(exit_code::bad_file, title_ + " is a directory. " + what_to_give);
  }
  id_ = id_of(status);
  if (id_) size_ = static_cast<std::uint64_t>(status.st_size);
}

input::~input() {
  if (fd_ != 0) ::close(fd_);
}

std::size_t input::read(std::span<std::uint8_t> into) {
  while (interrupt() == 0) {
    const ssize_t count = ::read(fd_, into.data(), into.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EIO && ::isatty(fd_) != 0) return 0;  // the other side of a terminal has gone
    if (errno == EAGAIN && wait_for_input(fd_, -1) == wake::input) continue;
    if (errno == EINTR || errno == EAGAIN) continue;
    throw failure(exit_code::bad_file,
                  fmt::format("cannot read {}: {}. Check the disk or the device it lies on, or "
                              "make a copy of it and give that.",
                              title_, std::strerror(errno)));
  }
  return 0;
}

bool input::would_wait() const noexcept { return !id_ && g4_dump::would_wait(fd_); }

}  // namespace g4_dump
