// SPDX-License-Identifier: MIT
// Trouble with what carries the bytes: ports, connections and files of this computer.
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "scenario.hpp"
#include "support/patience.hpp"
#include "transport/fd_port.hpp"
#include "transport/listener.hpp"
#include "transport/pty.hpp"
#include "transport/tcp_port.hpp"
#include "transport/temporary_file.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

using trouble = std::optional<error>;

constexpr std::int64_t patience_ns = std::chrono::nanoseconds(patience).count();

trouble opening(const std::string& which) { return error_in(lidar::open(which)); }

sim::device a_lidar(std::optional<sim::fault_kind> wrong = std::nullopt) {
  if (!wrong) return sim::device(sim::built_in_world());
  const std::array faults{sim::make_fault(*wrong)};
  return sim::device(sim::built_in_world(), {}, faults);
}

// ---- permission ---------------------------------------------------------------------------------

/// The error of `fails` for a user who is not root.
template <class Fails>
trouble as_nobody(Fails fails) {
  if (::geteuid() != 0) return fails();
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t nobody = 65534;
    const bool dropped = ::setgid(nobody) == 0 && ::setuid(nobody) == 0;
    if (const trouble reported = dropped ? fails() : std::nullopt) {
      static_cast<void>(!::write(pipe[1], &*reported, sizeof *reported));
    }
    ::_exit(0);
  }
  ::close(pipe[1]);
  error reported(task::finding, problem::system, "no word from the other user");
  const bool has_reported = ::read(pipe[0], &reported, sizeof reported) == sizeof reported;
  ::close(pipe[0]);
  ::waitpid(child, nullptr, 0);
  return has_reported ? trouble(reported) : std::nullopt;
}
static_assert(std::is_trivially_copyable_v<error>);

trouble not_permitted() {
  const pty port;
  ::chmod(port.path().c_str(), 0);
  return as_nobody([&] { return opening(port.path()); });
}

// ---- other programs -----------------------------------------------------------------------------

trouble opened_twice() {
  const pty port;
  const auto first = serial_port::open(port.path());
  if (!first) return first.error();
  return opening(port.path());
}

/// Another program, which has had the port open before, writes to it and takes what comes.
class prober {
 public:
  explicit prober(const std::string& path) {
    std::array<int, 2> pipe{};
    static_cast<void>(!::pipe(pipe.data()));
    child_ = ::fork();
    if (child_ == 0) probe(path.c_str(), pipe[1]);
    ::close(pipe[1]);
    char ready = 0;
    static_cast<void>(!::read(pipe[0], &ready, 1));
    ::close(pipe[0]);
  }
  prober(const prober&) = delete;
  prober& operator=(const prober&) = delete;
  ~prober() {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }

 private:
  [[noreturn]] static void probe(const char* path, int ready) {
    ::prctl(PR_SET_NAME, "ModemManager");
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (int fd = 3; fd < 256; ++fd) {  // it does not play the device, as its parent does
      if (fd != ready) ::close(fd);
    }
    const int port = ::open(path, O_RDWR | O_NOCTTY);
    std::array<char, 64> answer{};
    bool good = ::write(ready, "", 1) == 1 && ::write(port, "AT\r", 3) == 3;
    while (good) good = ::read(port, answer.data(), answer.size()) > 0;
    ::pause();
    ::_exit(0);
  }

  pid_t child_ = -1;
};

/// All answers go to the other program: it is as if none came.
trouble answers_stolen() {
  const auto port = sim::background_pty::open(a_lidar(sim::fault_kind::mute));
  if (!port) return port.error();
  const prober other(port->path());
  return opening(port->path());
}

trouble bytes_stolen() {
  const pty port;
  system_calls calls = real_system_calls();
  calls.read = [](int fd, void* out, std::size_t size) -> ssize_t {
    static_cast<void>(!::read(fd, out, size));  // the other's
    errno = EAGAIN;
    return -1;
  };
  const auto opened = open_serial_transport(port.path(), {}, calls);
  if (!opened) return opened.error();
  std::array<std::uint8_t, 64> buffer{};
  for (int burst = 0; burst < 10; ++burst) {
    port.send("a burst");
    const auto got = (*opened)->read(buffer, (*opened)->now_ns() + 100'000'000);
    if (!got) return got.error();
  }
  return std::nullopt;
}

trouble settings_changed() {
  const auto port = sim::background_pty::open(a_lidar());
  if (!port) return port.error();
  auto device = lidar::open(port->path());
  if (!device) return device.error();
  const int other = ::open(port->path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  ::tcgetattr(other, &settings);
  settings.c_lflag |= ICANON;
  ::tcsetattr(other, TCSANOW, &settings);
  ::close(other);
  return error_in(device->ask(requests::health()));
}

// ---- the port itself ----------------------------------------------------------------------------

trouble a_file_as_port() {
  const temporary_file file("no port");
  const auto opened = serial_port::open(file.path());
  return opened ? trouble() : opened.error();
}

/// A bridge that takes another rate than it is reported.
trouble slower_bridge() {
  const pty port;
  system_calls calls = real_system_calls();
  calls.tcgetattr = [](int fd, termios* out) {
    const int got = ::tcgetattr(fd, out);
    ::cfsetspeed(out, B115200);
    return got;
  };
  return error_in(open_serial_transport(port.path(), {}, calls));
}

trouble too_many_open_files() {
  const pty port;
  system_calls calls = real_system_calls();
  calls.open = [](const char*, int) {
    errno = EMFILE;
    return -1;
  };
  return error_in(open_serial_transport(port.path(), {}, calls));
}

trouble pulled_out() {
  pty port;
  const auto opened = serial_port::open(port.path());
  if (!opened) return opened.error();
  port.unplug();
  std::array<std::uint8_t, 64> buffer{};
  return error_in((*opened)->read(buffer, (*opened)->now_ns() + patience_ns));
}

// ---- connections and files ----------------------------------------------------------------------

trouble nobody_listens() {
  listener bridge;
  bridge.close();
  return opening("tcp:" + bridge.address());
}

trouble bridge_closes() {
  listener bridge;
  const auto opened = tcp_port::open(bridge.address());
  if (!opened) return opened.error();
  bridge.accept();
  bridge.hang_up();
  std::array<std::uint8_t, 64> buffer{};
  return error_in((*opened)->read(buffer, (*opened)->now_ns() + patience_ns));
}

trouble recording_ends() {
  const temporary_file file("not a packet");
  auto recording = lidar::open("file:" + file.path());
  if (!recording) return recording.error();
  if (auto started = recording->start(); !started) return started.error();
  return error_in(recording->try_scan(500ms));
}

trouble recording_asked() {
  const temporary_file file("not a packet");
  auto recording = lidar::open("file:" + file.path());
  if (!recording) return recording.error();
  return error_in(recording->ask(requests::health()));
}

trouble no_recording() {
  const temporary_file file("\x89MCAP0\r\nand nothing more");
  return error_in(lidar::open("file:" + file.path()));
}

}  // namespace

std::vector<scenario> port_scenarios() {
  using enum problem;
  return {
      {"NoSuchPort", no_port, task::opening, true, "/dev/ttyNothing",
       [] { return opening("/dev/ttyNothing"); }},
      {"NoSuchFile", no_port, task::opening, true, "no-such-walk.mcap",
       [] { return opening("no-such-walk.mcap"); }},
      {"SimulatedWrongly", bad_option, task::opening, true, "sim: (seed: 'x' is not",
       [] { return opening("sim:?seed=x"); }},
      {"NotPermitted", permission, task::opening, true, " of group ", not_permitted},
      {"OpenedTwice", busy, task::opening, true, ", held by error_tests (", opened_twice},
      {"NoTerminal", not_serial, task::opening, true, "/dev/null",
       [] { return opening("/dev/null"); }},
      {"AFileAsPort", not_serial, task::opening, true,
       ", a file, which opens as file:", a_file_as_port},
      {"SlowerBridge", bad_baud_rate, task::configuring, true, " at 230400 baud", slower_bridge},
      {"TooManyOpenFiles", system, task::opening, true, "/dev/pts/", too_many_open_files},
      {"PulledOut", gone, task::reading, true, "/dev/pts/", pulled_out},
      {"AnswersStolen", interference, task::opening, true, ", also used by ModemManager (",
       answers_stolen},
      {"BytesStolen", interference, task::reading, true, "/dev/pts/", bytes_stolen},
      {"SettingsChanged", interference, task::asking, true, ", whose settings were changed",
       settings_changed},
      {"NoAddress", bad_option, task::opening, true, "tcp:nowhere, not tcp:host:port",
       [] { return opening("tcp:nowhere"); }},
      {"NobodyListens", cannot_connect, task::opening, true, "tcp:127.0.0.1:", nobody_listens},
      {"BridgeCloses", end_of_input, task::reading, true, "tcp:127.0.0.1:", bridge_closes},
      {"RecordingEnds", end_of_input, task::reading, true, "bytes-", recording_ends},
      {"RecordingAsked", read_only, task::asking, false, "bytes-", recording_asked},
      {"NotARecording", bad_file, task::opening, true, "bytes-", no_recording},
      {"NoSuchRecording", system, task::opening, true, "/dev/no-recording",
       [] { return opening("file:/dev/no-recording"); }},
      {"NoRecording", bad_file, task::opening, true, "/dev", [] { return opening("file:/dev"); }},
  };
}

}  // namespace g4lidar::test
