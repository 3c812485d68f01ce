// SPDX-License-Identifier: MIT
// The cost of the driver: on a pty in real time, on a pty without a rate limit, and per sample in
// memory.
//   device_bench delay SECONDS [PACE]   from the end of a zero packet to the delivered scan, and the first scan
//   device_bench stream SECONDS [PACE]  CPU time, context switches, memory, calls of operator new
//                                 and delete while streaming
// PACE is `packets`, `scans` (the default), or a batch in milliseconds; of delay also `bare`: a loop of poll and read
// without the driver.
//   device_bench flood MEGABYTES  bytes per second from a pty, relative to a reader that only counts
//                                 and the driver on bytes in memory, one after the other
//   device_bench memory SCANS [BURST [judged|MODEL]]  scans from memory, in bursts of so many bytes, for counting
//                                 instructions; `judged`: with a running_diagnosis; MODEL: in its layout of samples
#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>

#include "g4lidar/core/command.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/transport/transport.hpp"
#include "memory_connector.hpp"
#include "pty_writer.hpp"
#include "recode.hpp"
#include "support/allocation_count.hpp"

namespace {

using namespace g4lidar;
using namespace std::chrono_literals;
using bench::steady_ns;

constexpr std::int64_t second = 1'000'000'000;

[[noreturn]] void fail(const error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  std::exit(1);
}

lidar open_and_start(const std::string& path, std::string_view pace = "scans") {
  lidar_options options;
  options.device = path;
  if (pace == "packets") {
    options.tuning.pace = read_pace::packets;
  } else if (pace != "scans") {
    options.tuning.batch = std::chrono::milliseconds(std::atoi(pace.data()));
  }
  auto opened = lidar::open(options);
  if (!opened) fail(opened.error());
  if (auto started = opened->start(); !started) fail(started.error());
  return std::move(*opened);
}

double ms_of(std::int64_t ns) { return static_cast<double>(ns) / 1e6; }

using taken_scans = std::vector<std::pair<std::uint32_t, std::int64_t>>;  // revolution, when

/// What a program without a driver would do: poll, read, and parse each packet. When it has each zero packet.
taken_scans zero_packets_of_a_bare_loop(const std::string& path, std::int64_t end) {
  const int port = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const auto start = encode(command::start);
  static_cast<void>(::write(port, start.data(), start.size()));
  taken_scans taken;
  stream_parser parser;
  std::array<std::uint8_t, 4096> buffer;
  while (steady_ns() < end) {
    pollfd ready{port, POLLIN, 0};
    static_cast<void>(poll(&ready, 1, 500));
    const ssize_t count = ::read(port, buffer.data(), buffer.size());
    bytes input(buffer.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
    while (const auto found = parser.next(input)) {
      const auto* const packet = std::get_if<packet_view>(&*found);
      if (packet == nullptr || !packet->is_zero()) continue;
      taken.emplace_back(static_cast<std::uint32_t>(taken.size()), steady_ns());
    }
  }
  const auto stop = encode(command::stop);
  static_cast<void>(::write(port, stop.data(), stop.size()));
  ::close(port);
  return taken;
}

int delay(int seconds, std::string_view pace) {
  const bench::pty pty;
  std::vector<std::int64_t> written;
  const std::int64_t end = steady_ns() + seconds * second;
  std::thread writer([&] {
    bench::use_processor(0);
    bench::feed_in_real_time(pty.master(), end + 2 * second, written);
  });
  bench::use_processor(1);
  const std::int64_t begin = steady_ns();
  std::int64_t opened = 0;
  std::int64_t first = 0;
  taken_scans taken;
  if (pace == "bare") {
    taken = zero_packets_of_a_bare_loop(pty.path(), end);
  } else {
    lidar device = open_and_start(pty.path(), pace);
    opened = steady_ns();
    while (steady_ns() < end) {
      const auto scan = device.try_scan(500ms);
      const std::int64_t now = steady_ns();
      if (!scan) continue;
      if (first == 0) first = now;
      taken.emplace_back(scan->revolution, now);
    }
  }
  writer.join();
  // Revolution r ends with zero packet r: packet 0 is the end of the partial one.
  std::vector<double> delays;
  for (const auto& [revolution, when] : taken) {
    if (revolution < written.size()) delays.push_back(ms_of(when - written[revolution]));
  }
  if (delays.empty()) return 1;
  std::sort(delays.begin(), delays.end());
  std::printf("delay_median_ms %.3f\nopen_and_start_ms %.1f\nfirst_scan_ms %.1f\n",
              delays[delays.size() / 2], ms_of(opened - begin), ms_of(first - begin));
  for (const double each : delays) std::printf("delay_ms %.3f\n", each);
  return 0;
}

/// What it holds now: the peak that getrusage() gives is that of the shell before, too, and VmRSS in status of
/// /proc is inexact (proc(5)).
long resident_kib() {
  std::FILE* const rollup = std::fopen("/proc/self/smaps_rollup", "r");
  long found = 0;
  std::array<char, 256> text{};
  while (rollup != nullptr && std::fgets(text.data(), text.size(), rollup) != nullptr) {
    if (std::sscanf(text.data(), "Rss: %ld", &found) == 1) break;
  }
  if (rollup != nullptr) std::fclose(rollup);
  return found;
}

int stream(int seconds, std::string_view pace) {
  const bench::pty pty;
  const std::int64_t end = steady_ns() + (seconds + 3) * second;
  const pid_t writer = fork();
  if (writer == 0) {
    std::vector<std::int64_t> ignored;
    bench::feed_in_real_time(pty.master(), end + second, ignored);
    _exit(0);
  }
  {
    lidar device = open_and_start(pty.path(), pace);
    const auto until = [&](std::int64_t time) {
      while (steady_ns() < time) static_cast<void>(device.try_scan(500ms));
    };
    until(end - (seconds + 1) * second);
    // A tracer sees these two flags and counts between them.
    static_cast<void>(::write(STDERR_FILENO, "begin\n", 6));
    rusage before{};
    rusage after{};
    getrusage(RUSAGE_SELF, &before);
    const lidar_counts counts = device.counts();
    const std::size_t allocations = test::allocations_so_far();
    until(steady_ns() + seconds * second);
    getrusage(RUSAGE_SELF, &after);
    const std::size_t allocated = test::allocations_so_far() - allocations;
    static_cast<void>(::write(STDERR_FILENO, "end\n", 4));
    const auto seconds_of = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
    };
    const double cpu = seconds_of(after.ru_utime) + seconds_of(after.ru_stime) -
                       seconds_of(before.ru_utime) - seconds_of(before.ru_stime);
    std::printf(
        "cpu_s_per_minute %.3f\nswitches_per_s %.0f\nresident_kib %ld\nscans %llu\n"
        "samples_lost %llu\nheap_calls %zu\n",
        cpu * 60 / seconds,
        static_cast<double>(after.ru_nvcsw + after.ru_nivcsw - before.ru_nvcsw - before.ru_nivcsw) /
            seconds,
        resident_kib(), static_cast<unsigned long long>(device.counts().scans - counts.scans),
        static_cast<unsigned long long>(device.counts().samples_lost), allocated);
  }
  waitpid(writer, nullptr, 0);
  return 0;
}

/// Bytes per second of a reader that polls, reads, and counts.
double counting_rate(std::size_t bytes_wanted) {
  const bench::pty pty;
  const bench::recording revolutions = bench::record(20);
  std::atomic<bool> done = false;
  std::thread writer([&] {
    bench::flood(pty.master(), revolutions.data, bytes_wanted);
    done = true;
  });
  const int port = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const auto start = encode(command::start);
  static_cast<void>(::write(port, start.data(), start.size()));
  std::vector<std::uint8_t> buffer(65536);
  std::size_t seen = 0;
  std::int64_t begin = 0;
  while (seen < bytes_wanted) {
    pollfd ready{port, POLLIN, 0};
    static_cast<void>(poll(&ready, 1, 1000));
    const ssize_t count = ::read(port, buffer.data(), buffer.size());
    if (count > 0) seen += static_cast<std::size_t>(count);
    if (begin == 0 && seen > 1000) begin = steady_ns();
  }
  const double rate = static_cast<double>(seen) * 1e9 / static_cast<double>(steady_ns() - begin);
  while (!done) static_cast<void>(::read(port, buffer.data(), buffer.size()));
  writer.join();
  ::close(port);
  return rate;
}

/// Bytes per second of the driver, and its lost scans.
double driver_rate(std::size_t bytes_wanted, std::int64_t& lost) {
  const bench::pty pty;
  const bench::recording revolutions = bench::record(20);
  const std::size_t rounds = (bytes_wanted + revolutions.data.size() - 1) / revolutions.data.size();
  std::atomic<bool> done = false;
  std::thread writer([&] {
    bench::flood(pty.master(), revolutions.data, bytes_wanted);
    done = true;
  });
  lidar device = open_and_start(pty.path());
  const auto expected = static_cast<std::int64_t>(rounds * 20 - 1);  // the last one has no end
  std::int64_t scans = 0;
  std::int64_t begin = 0;
  while (scans < expected) {
    const auto scan = device.try_scan(1000ms);
    if (!scan) break;
    if (begin == 0) begin = steady_ns();
    ++scans;
  }
  const double rate =
      static_cast<double>(device.counts().bytes) * 1e9 / static_cast<double>(steady_ns() - begin);
  lost = expected - scans;
  while (!done) static_cast<void>(device.next_points(1ms));
  writer.join();
  return rate;
}

/// What the driver took from memory, without a system call.
struct memory_run {
  std::size_t samples = 0;
  std::size_t whole = 0;
  double bytes_per_s = 0.0;
};

memory_run read_memory(int scans, int burst, bool is_judged = false,
                       const model& which = g4_model) {
  bench::recording revolutions = bench::record(20);
  revolutions.data = bench::recoded(revolutions.data, which);
  running_diagnosis judge;
  std::unique_ptr<connector> from = std::make_unique<bench::memory_connector>(
      revolutions, static_cast<std::size_t>(scans), static_cast<std::size_t>(burst), which);
  if (is_judged) from = judge.observe(std::move(from));
  lidar_options options;
  options.model = &which;
  auto opened = lidar::open(std::move(from), options);
  if (!opened) fail(opened.error());
  if (auto started = opened->start(); !started) fail(started.error());
  memory_run all;
  const std::int64_t begin = steady_ns();
  while (true) {
    const auto scan = opened->try_scan(1000ms);
    if (!scan) break;
    all.samples += scan->points.size();
    all.whole += scan->is_whole();
  }
  all.bytes_per_s =
      static_cast<double>(opened->counts().bytes) * 1e9 / static_cast<double>(steady_ns() - begin);
  return all;
}

int memory(int scans, int burst, std::string_view how) {
  const bool is_judged = how == "judged";
  const model* const which = is_judged ? &g4_model : model_named(how);
  if (which == nullptr) {
    std::fprintf(stderr, "no model has this name: %s\n", how.data());
    return 2;
  }
  const memory_run all = read_memory(scans, burst, is_judged, *which);
  std::printf("samples %zu\nscans %zu\n", all.samples, all.whole);
  return 0;
}

/// How much faster or slower the driver takes bytes from a pty than the system and the driver need
/// for them one after the other: a reader that only counts, and the driver on bytes in memory. The
/// median of 9 ratios, each of three measurements one after the other: other load of the machine
/// makes all slower.
int flood(int megabytes) {
  constexpr std::size_t runs = 9;
  const std::size_t wanted = static_cast<std::size_t>(megabytes) * 1'000'000;
  const auto scans = static_cast<int>(wanted / 4000);  // about as many bytes
  std::int64_t lost = 0;
  std::array<double, runs> ratios{};
  std::array<double, runs> rates{};
  for (std::size_t i = 0; i < runs; ++i) {
    std::int64_t lost_now = 0;
    const double counting_s = 1.0 / counting_rate(wanted);
    const double memory_s = 1.0 / read_memory(scans, 4095).bytes_per_s;
    rates[i] = driver_rate(wanted, lost_now);
    ratios[i] = rates[i] * (counting_s + memory_s);
    lost += lost_now;
  }
  std::sort(ratios.begin(), ratios.end());
  std::sort(rates.begin(), rates.end());
  std::printf("flood_ratio %.2f\nflood_mb_per_s %.1f\nscans_lost %lld\n", ratios[runs / 2],
              rates[runs / 2] / 1e6, static_cast<long long>(lost));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view mode = argc > 1 ? argv[1] : "";
  const int amount = argc > 2 ? std::atoi(argv[2]) : 10;
  const std::string_view pace = argc > 3 ? argv[3] : "scans";
  if (mode == "delay") return delay(amount, pace);
  if (mode == "stream") return stream(amount, pace);
  if (mode == "flood") return flood(amount);
  if (mode == "memory") {
    return memory(amount, argc > 3 ? std::atoi(argv[3]) : 256, argc > 4 ? argv[4] : "g4");
  }
  std::fprintf(stderr, "device_bench delay|stream|flood|memory AMOUNT: see the source\n");
  return 2;
}
