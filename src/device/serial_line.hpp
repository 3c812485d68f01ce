// SPDX-License-Identifier: MIT
// An opened serial port, and what is put back when it is closed.
#pragma once

#include <optional>
#include <string>

#include "fd_port.hpp"
#include "g4lidar/serial_port.hpp"

namespace g4lidar {

/// serial_port::open(), with the system calls of a test.
[[nodiscard]] result<std::unique_ptr<transport>> open_serial_line(std::string_view path,
                                                                  const serial_options& options,
                                                                  const system_calls& calls);

class serial_line final : public fd_port {
 public:
  serial_line(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
              std::string path, std::uint32_t baud) noexcept;
  ~serial_line() override;

  // In this order, each once. What fails is undone by the destructor.
  [[nodiscard]] result<void>
  look() noexcept;  ///< At the line as it is; not_serial where it is none.
  [[nodiscard]] result<void> hold();
  [[nodiscard]] result<void> configure() noexcept;
  void hasten() noexcept;
  [[nodiscard]] result<void> discard_input() noexcept;

 private:
  [[nodiscard]] ssize_t write_some(bytes data) noexcept override;

  [[nodiscard]] int control(unsigned long request, void* argument) const noexcept;
  [[nodiscard]] tl::unexpected<error> refused(int system_errno) const noexcept;
  [[nodiscard]] tl::unexpected<error> refused_baud(int system_errno) const noexcept;
  [[nodiscard]] tl::unexpected<error> held() const;
  [[nodiscard]] bool set(int when, const termios& wanted) const noexcept;
  [[nodiscard]] bool drained() const noexcept;
  void restore() noexcept;

  termios found_{};
  std::uint32_t found_custom_baud_ = 0;  // where it had a rate without a name
  int found_flags_ = 0;
  bool is_changed_ = false;
  bool is_exclusive_ = false;
  bool is_hastened_ = false;
};

}  // namespace g4lidar
