// SPDX-License-Identifier: MIT
#include "byte_source.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include "format.hpp"
#include "transport/owned_fd.hpp"
#include "transport/system_calls.hpp"

namespace g4lidar::mcap {
namespace {

class file_source final : public byte_source {
 public:
  file_source(owned_fd fd, std::uint64_t size, std::string path) noexcept
      : fd_(std::move(fd)), size_(size), path_(std::move(path)) {}

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

 private:
  [[nodiscard]] result<std::size_t> read_some(std::uint64_t offset,
                                              std::span<std::uint8_t> out) noexcept override {
    std::size_t done = 0;
    while (done < out.size()) {
      const auto from = static_cast<off_t>(offset + done);
      const ssize_t count = uninterrupted(
          [&] { return ::pread(fd_.get(), out.data() + done, out.size() - done, from); });
      if (count < 0) return failure(task::reading, problem::system, path_, errno);
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }

  owned_fd fd_;
  std::uint64_t size_;
  std::string path_;
};

}  // namespace

result<std::shared_ptr<byte_source>> open_file_source(std::string_view path) {
  std::string name(path);
  constexpr int flags = O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;  // it may be a pipe
  owned_fd fd(uninterrupted([&] { return ::open(name.c_str(), flags); }));
  if (fd.get() < 0) return failure(task::opening, problem::system, path, errno);
  struct stat file{};
  if (::fstat(fd.get(), &file) != 0) return failure(task::opening, problem::system, path, errno);
  if (!S_ISREG(file.st_mode)) {
    return failure(task::opening, problem::bad_option, name + " is not a file");
  }
  return std::make_shared<file_source>(std::move(fd), static_cast<std::uint64_t>(file.st_size),
                                       std::move(name));
}

bool has_magic(byte_source& file) noexcept {
  std::array<std::uint8_t, magic.size()> begin{};
  return file.read(0, begin) == begin.size() && begin == magic;
}

}  // namespace g4lidar::mcap
