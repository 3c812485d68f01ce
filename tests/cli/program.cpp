// SPDX-License-Identifier: MIT
// Starting and listening, by plain system calls.
#include "program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "support/patience.hpp"

namespace cli {
namespace {

/// Ten times the longest run on an idle machine: 20 s of a simulated lidar. The time limit of a test is longer.
constexpr std::chrono::seconds longest_run{210};

[[noreturn]] void give_up(const std::string& what) { throw std::runtime_error(what); }

void close_one(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

/// Leads the child's `number` to where it shall go; gives our end of a pipe, or -1.
int lead(posix_spawn_file_actions_t& actions, const stream& where, int number,
         std::vector<int>& theirs) {
  switch (where.to) {
    case stream::kind::file:
      posix_spawn_file_actions_addopen(&actions, number, where.file.c_str(),
                                       number == 0 ? O_RDONLY : O_WRONLY | O_CREAT | O_TRUNC, 0666);
      return -1;
    case stream::kind::closed:
      posix_spawn_file_actions_addclose(&actions, number);
      return -1;
    case stream::kind::descriptor:
      posix_spawn_file_actions_adddup2(&actions, where.descriptor, number);
      return -1;
    case stream::kind::pipe:
      break;
  }
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) give_up("no pipe");
  const int their_end = number == 0 ? ends[0] : ends[1];
  posix_spawn_file_actions_adddup2(&actions, their_end, number);
  theirs.push_back(their_end);
  return number == 0 ? ends[1] : ends[0];
}

}  // namespace

program::program(const std::vector<std::string>& arguments, const streams& leading) {
  ::signal(SIGPIPE, SIG_IGN);
  const std::string name = G4_DUMP;
  std::vector<std::string> words;
  if (std::getenv("VALGRIND") != nullptr) {
    words = {"valgrind", "--quiet", "--error-exitcode=9", "--trace-children=yes"};
  }
  words.push_back(name);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  std::vector<int> theirs;
  in_ = lead(actions, leading.in, 0, theirs);
  out_ = lead(actions, leading.out, 1, theirs);
  err_ = lead(actions, leading.err, 2, theirs);
  posix_spawnattr_t attributes;  // the signals as a shell in the foreground leaves them
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGHUP}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawnp(&pid_, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  for (const int end : theirs) ::close(end);
  if (error != 0) give_up("cannot start " + name);
}

program::~program() {
  close_one(in_);
  close_one(out_);
  close_one(err_);
  if (pid_ <= 0) return;
  // A killed simulator leaves its link, which can lead to the pseudo-terminal of another test.
  ::kill(pid_, SIGTERM);
  if (g4lidar::test::comes_true([&] { return ::waitpid(pid_, nullptr, WNOHANG) != 0; })) return;
  ADD_FAILURE() << "SIGTERM does not end it";
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void program::feed(std::string_view data) {
  while (!data.empty() && in_ >= 0) {
    // Listening all the while, so that neither side waits for the other for ever.
    std::array<pollfd, 1> writable{{{in_, POLLOUT, 0}}};
    while (::poll(writable.data(), 1, 1) == 0) read_some(1);
    const ssize_t count = ::write(in_, data.data(), std::min<std::size_t>(data.size(), 4096));
    if (count < 0 && errno == EPIPE) return close_input();
    if (count > 0) data.remove_prefix(static_cast<std::size_t>(count));
  }
}

void program::close_input() { close_one(in_); }
void program::close_output() { close_one(out_); }
bool program::input_is_dead() const {
  pollfd end{in_, 0, 0};
  return ::poll(&end, 1, 0) > 0 && (end.revents & POLLERR) != 0;
}
bool program::has_read_its_input() const {
  int left = -1;
  return ::ioctl(in_, FIONREAD, &left) == 0 && left == 0;
}
void program::send(int signal) const { ::kill(pid_, signal); }

bool program::handles(int signal) const {
  const std::string status = read_file("/proc/" + std::to_string(pid_) + "/status");
  const std::string name = "SigCgt:";  // a mask in hexadecimal digits
  const std::size_t at = status.find(name);
  return at != std::string::npos &&
         (std::stoull(status.substr(at + name.size()), nullptr, 16) >> (signal - 1) & 1U) != 0;
}

bool program::read_some(int timeout_ms) {
  std::array<pollfd, 2> readable{{{out_, POLLIN, 0}, {err_, POLLIN, 0}}};
  if (out_ < 0 && err_ < 0) return false;
  if (::poll(readable.data(), 2, timeout_ms) <= 0) return true;
  std::array<char, 65536> part;
  const auto take = [&part](int& fd, std::string& text) {
    const ssize_t count = ::read(fd, part.data(), part.size());
    if (count <= 0) return close_one(fd);
    text.append(part.data(), static_cast<std::size_t>(count));
  };
  if (readable[0].revents != 0) take(out_, so_far_.out);
  if (readable[1].revents != 0) take(err_, so_far_.err);
  return true;
}

std::string program::read_until(std::string_view text) {
  const auto end = std::chrono::steady_clock::now() + g4lidar::test::patience;
  while (so_far_.out.find(text) == std::string::npos) {
    if (std::chrono::steady_clock::now() > end) {
      ADD_FAILURE() << "not in its output after " << g4lidar::test::patience.count()
                    << " s: " << text;
      break;
    }
    if (!read_some(100)) break;
  }
  return so_far_.out;
}

outcome program::wait() {
  close_input();
  const auto end = std::chrono::steady_clock::now() + longest_run;
  while (read_some(100)) {
    if (std::chrono::steady_clock::now() < end) continue;
    ADD_FAILURE() << "it does not end";
    ::kill(pid_, SIGKILL);
    break;
  }
  int status = 0;
  rusage usage{};
  while (::wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  if (WIFEXITED(status)) so_far_.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) so_far_.signal = WTERMSIG(status);
  so_far_.max_rss_kib = usage.ru_maxrss;
  return so_far_;
}

outcome run(const std::vector<std::string>& arguments, std::string_view input) {
  program started(arguments);
  started.feed(input);
  return started.wait();
}

outcome run_on_full_disk(std::uint64_t bytes, const std::vector<std::string>& arguments) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{bytes, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const outcome done = run(arguments);
  ::setrlimit(RLIMIT_FSIZE, &before);
  return done;
}

scratch::scratch() {
  std::string name = std::filesystem::temp_directory_path() / "g4-dump-test-XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) give_up("no scratch directory");
  directory_ = name;
}

scratch::~scratch() {
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

std::string scratch::listing() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

std::string read_file(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) give_up("cannot read " + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void write_file(const std::string& name, std::string_view text) {
  std::ofstream file(name, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void write_repeated(const std::string& name, std::string_view block, std::uint64_t size) {
  std::ofstream file(name, std::ios::binary);
  for (std::uint64_t written = 0; written < size; written += block.size()) {
    file.write(block.data(), static_cast<std::streamsize>(block.size()));
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace cli
