// SPDX-License-Identifier: MIT
// A handler stores the signal and writes to a pipe, which poll() watches beside the input.
#include "interrupt.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>

namespace g4_tool {
namespace {

volatile std::sig_atomic_t caught = 0;
std::array<int, 2> wake_pipe{-1, -1};

void keep_signal(int number) {
  const int error = errno;
  caught = number;
  const char byte = 0;
  [[maybe_unused]] const auto ignored = ::write(wake_pipe[1], &byte, 1);
  errno = error;
}

}  // namespace

void prepare_process() {
  // open() returns the lowest free number, which is the missing one.
  for (const int standard : {0, 1, 2}) {
    if (::fcntl(standard, F_GETFD) < 0) {
      [[maybe_unused]] const int fd = ::open("/dev/null", O_RDONLY);
    }
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  if (::pipe2(wake_pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0) return;
  struct sigaction action{};
  action.sa_handler = keep_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before{};
    ::sigaction(number, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(number, &action, nullptr);  // as under nohup
  }
}

int interrupt() noexcept { return caught; }

int exit_code_now() noexcept { return caught == 0 ? 0 : 128 + caught; }

int interrupt_handle() noexcept { return wake_pipe[0]; }

wake wait_for_input(int input, int output, std::chrono::steady_clock::time_point until) noexcept {
  using namespace std::chrono_literals;
  while (interrupt() == 0) {
    std::array<pollfd, 3> waiting{{{input, POLLIN, 0}, {wake_pipe[0], POLLIN, 0}, {output, 0, 0}}};
    const auto left = until == no_deadline ? 1h : until - std::chrono::steady_clock::now();
    // poll() with its milliseconds is too coarse for the wait for the end of a revolution.
    const std::chrono::nanoseconds time = std::clamp<std::chrono::nanoseconds>(left, 0ns, 1h);
    const timespec longest{static_cast<std::time_t>(time / 1s),
                           static_cast<long>((time % 1s).count())};
    const int woken = ::ppoll(waiting.data(), waiting.size(), &longest, nullptr);
    if (woken == 0 && left > 1h) continue;
    if (woken == 0 && until != no_deadline) return wake::timeout;
    if (woken < 0 && errno != EINTR) return wake::input;  // read() reports what is wrong
    if (woken <= 0) continue;
    if (waiting[1].revents != 0) break;
    if ((waiting[2].revents & (POLLERR | POLLHUP)) != 0) return wake::output_closed;
    return wake::input;  // or poll() does not support the output
  }
  return wake::interrupt;
}

int open_file(const std::string& name, int flags) {
  while (true) {
    const int fd = ::open(name.c_str(), flags | O_CLOEXEC | O_NOCTTY, 0666);
    if (fd >= 0 || errno != EINTR) return fd;
    if (interrupt() != 0) throw interrupted();
  }
}

}  // namespace g4_tool
