// SPDX-License-Identifier: MIT
#include "byte_survey.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <vector>

#include "g4lidar/recording/raw_bytes.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

owned_fd open_bytes(const std::string& name) noexcept {
  constexpr int flags = O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;  // a pipe without a writer
  return owned_fd(name == "-" ? ::fcntl(0, F_DUPFD_CLOEXEC, 3) : ::open(name.c_str(), flags));
}

recognised_model model_of(const stream_survey& seen) noexcept {
  return {&seen.layout().most_likely(), seen.layout().basis(), seen.layout().rate_hz(),
          seen.layout().frequency_chz()};
}

stream_survey surveyed_at(const owned_fd& fd, off_t offset) {
  constexpr std::size_t enough = std::size_t{64} << 10U;
  constexpr off_t most = off_t{1} << 20U;
  stream_survey seen;
  std::vector<std::uint8_t> piece(enough);
  for (off_t read = 0; read < most && (read == 0 || seen.layout().sample_bytes() == 0);) {
    const ssize_t count =
        uninterrupted([&] { return ::pread(fd.get(), piece.data(), piece.size(), offset + read); });
    if (count <= 0) break;
    seen.received(bytes(piece).first(static_cast<std::size_t>(count)));
    read += count;
  }
  if (seen.layout().sample_bytes() == 0) seen.finish();
  return seen;
}

std::optional<error> refusal_of(const stream_survey& seen, std::string_view title,
                                const model* named) {
  const std::size_t size = seen.layout().sample_bytes();
  const bool is_certain = seen.layout().votes(size) >= certain_packets;
  if (named != nullptr && is_certain && size != sample_size(named->samples.layout))
    return error(task::opening, problem::other_device,
                 std::string(title) + ", packets with samples of " + std::to_string(size) +
                     " bytes, not of " + std::to_string(sample_size(named->samples.layout)),
                 0, error_detail::other_samples);
  if (seen.layout().has_packet()) return std::nullopt;
  if (const other_maker* const other = seen.maker()) {
    return error(task::opening, problem::other_device,
                 std::string(title).append(", ").append(with_driver(*other)), 0,
                 error_detail::other_maker);
  }
  if (seen.text() == text_kind::none) return std::nullopt;
  return error(task::opening, problem::bad_file,
               std::string(title).append(": ").append(seen.finding()), 0,
               error_detail::known_bytes);
}

namespace {

/// Nothing if it is not a regular file.
std::optional<stream_survey> surveyed_in(const std::string& path) {
  struct stat file{};
  const bool is_known = (path == "-" ? ::fstat(0, &file) : ::stat(path.c_str(), &file)) == 0;
  if (!is_known || !S_ISREG(file.st_mode)) return std::nullopt;
  const owned_fd fd = open_bytes(path);
  return surveyed_at(fd, std::max<off_t>(::lseek(fd.get(), 0, SEEK_CUR), 0));
}

}  // namespace

recognised_model recognised_in(const std::string& path) {
  const auto seen = surveyed_in(path);
  return seen ? model_of(*seen) : recognised_model{};
}

std::optional<error> problem_with_bytes(const std::string& path, const model& named) {
  const auto seen = surveyed_in(path);
  return seen ? refusal_of(*seen, path, &named) : std::nullopt;
}

const model& model_of_bytes(const std::string& path) { return *recognised_in(path).which; }

std::string what_is(bytes data) {
  stream_survey seen;
  seen.received(data);
  seen.finish();
  return seen.finding();
}

}  // namespace g4lidar
