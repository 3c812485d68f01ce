// SPDX-License-Identifier: MIT
// The device's clock is the steady clock since it was opened; the loop sleeps between two events.
#include "g4lidar/sim/pty_port.hpp"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include <filesystem>

#include "name_claim.hpp"
#include "served_port.hpp"

namespace g4lidar::sim {
namespace {

namespace fs = std::filesystem;

// More frequent wake-ups have no use.
constexpr std::int64_t shortest_sleep_ns = 500'000;

std::int64_t steady_ns() noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A symbolic link to a pty, which may be replaced.
bool leads_to_a_pty(const fs::path& link) {
  std::error_code none;
  const fs::path target = fs::read_symlink(link, none);
  return !none && target.native().starts_with("/dev/pts/");
}

// Replaced atomically: there is always a link.
result<void> point(const fs::path& link, const std::string& target) {
  std::error_code wrong;
  const fs::file_status there = fs::symlink_status(link, wrong);
  if (fs::exists(there) && !leads_to_a_pty(link)) {
    return failure(task::opening, problem::busy, link.native(), EEXIST);
  }
  fs::path fresh = link;
  fresh += "." + fs::path(target).filename().native() + ".new";
  fs::remove(fresh, wrong);
  fs::create_symlink(target, fresh, wrong);
  if (!wrong) fs::rename(fresh, link, wrong);
  if (wrong) return failure(task::opening, problem::system, link.native(), wrong.value());
  return {};
}

// The claim of a link, kept as long as a device uses it, also while it is unplugged.
result<owned_fd> claim_link_at(const std::string& link) {
  std::error_code none;
  const fs::path place = fs::absolute(link, none);
  const fs::path whole = fs::weakly_canonical(place.parent_path(), none) / place.filename();
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (const char c : whole.native()) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  std::array<char, 17> name{};
  std::snprintf(name.data(), name.size(), "%016llx", static_cast<unsigned long long>(hash));
  owned_fd held = name_claim(name.data()).hold();
  if (held) return held;
  const bool is_served = errno == EADDRINUSE;
  return failure(task::opening, is_served ? problem::busy : problem::system, link, errno);
}

void unpoint(const fs::path& link, const std::string& target) {
  std::error_code none;
  if (!link.empty() && fs::read_symlink(link, none) == target) fs::remove(link, none);
}

}  // namespace

class G4LIDAR_HIDDEN pty_port::state {
 public:
  /// At a link, without a link, or at a TCP address.
  state(device device, const std::string& link) : simulated(std::move(device)), link_(link) {
    simulated.host().ignore_dtr(0);
  }
  state(device device, std::string address, std::uint16_t port)
      : simulated(std::move(device)), address_(std::move(address)), port_(port) {
    simulated.host().ignore_dtr(0);
  }
  ~state() { unplug(); }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  result<void> open() {
    if (!link_.empty()) {
      result<owned_fd> held = claim_link_at(link_);
      if (!held) return tl::unexpected<error>(held.error());
      claim_ = std::move(*held);
    }
    return simulated.is_plugged(0) ? plug() : result<void>();
  }

  result<void> plug() {
    auto opened = address_.empty() ? open_pty() : listen_at(address_, port_);
    if (!opened) return tl::unexpected<error>(opened.error());
    served_ = std::move(*opened);
    if (!link_.empty()) {
      if (result<void> linked = point(link_, served_->name()); !linked) {
        served_.reset();
        return linked;
      }
    }
    path_ = link_.empty() ? served_->name() : link_;
    return {};
  }

  void unplug() {
    if (!served_) return;
    unpoint(link_, served_->name());
    served_.reset();
  }

  result<std::int64_t> process() {
    const std::int64_t now = now_ns();
    const bool plugged = simulated.is_plugged(now);
    if (served_ && (!plugged || simulated.replugs() != replugs_)) unplug();
    replugs_ = simulated.replugs();
    if (plugged && !served_) {
      if (const result<void> back = plug(); !back) return tl::unexpected<error>(back.error());
    }
    if (served_) carry(*served_, now);
    return std::max(simulated.next_ns(now), now + shortest_sleep_ns);
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept { return steady_ns() - begin_ns_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::uint64_t bytes_lost() const noexcept { return bytes_lost_; }
  [[nodiscard]] handles native_handles() const noexcept {
    return served_ ? handles{served_->handle(), served_->watch()} : handles{-1, -1};
  }

  device simulated;

 private:
  void carry(served_port& to, std::int64_t now) noexcept {
    to.look_for_clients();
    if (const std::uint32_t rate = to.baud(); rate != baud_) {
      baud_ = rate;
      simulated.host().set_baud(rate, now);
    }
    std::array<std::uint8_t, 4096> data;
    // A program that sends without end does not block the device.
    for (int turn = 0; turn < 4; ++turn) {
      const std::size_t count = to.read(data);
      if (count == 0) break;
      simulated.write(bytes(data).first(count), now);
    }
    while (const std::size_t count = simulated.read(data, now)) {
      bytes_lost_ += to.write(bytes(data).first(count));
    }
  }

  std::string link_;
  owned_fd claim_;  // of the link
  std::string path_;
  std::string address_;  // empty: a pseudo-terminal
  std::uint16_t port_ = 0;
  std::unique_ptr<served_port> served_;
  std::uint32_t baud_ = 0;  // that a program has set
  std::uint64_t replugs_ = 0;
  std::uint64_t bytes_lost_ = 0;
  std::int64_t begin_ns_ = steady_ns();
};

pty_port::pty_port(std::unique_ptr<state> made) noexcept : state_(std::move(made)) {}
pty_port::pty_port(pty_port&&) noexcept = default;
pty_port& pty_port::operator=(pty_port&&) noexcept = default;
pty_port::~pty_port() = default;

result<pty_port> pty_port::open(device simulated, const std::string& link) {
  return opened(std::make_unique<state>(std::move(simulated), link));
}

result<pty_port> pty_port::listen(device simulated, const std::string& address,
                                  std::uint16_t port) {
  return opened(std::make_unique<state>(std::move(simulated), address, port));
}

result<pty_port> pty_port::opened(std::unique_ptr<state> made) {
  if (const result<void> opened = made->open(); !opened) {
    return tl::unexpected<error>(opened.error());
  }
  return pty_port(std::move(made));
}

const std::string& pty_port::path() const noexcept { return state_->path(); }
std::int64_t pty_port::now_ns() const noexcept { return state_->now_ns(); }
device& pty_port::simulated() noexcept { return state_->simulated; }
std::uint64_t pty_port::bytes_lost() const noexcept { return state_->bytes_lost(); }
result<std::int64_t> pty_port::process() { return state_->process(); }
pty_port::handles pty_port::native_handles() const noexcept { return state_->native_handles(); }

result<void> serve(std::span<pty_port> ports, int stop, const std::function<void()>& after_each) {
  std::vector<pollfd> waiting;
  for (;;) {
    waiting.assign(1, {stop, POLLIN, 0});
    std::int64_t sleep_ns = forever_ns;
    for (pty_port& port : ports) {
      const result<std::int64_t> next = port.process();
      if (!next) return tl::unexpected<error>(next.error());
      if (*next != forever_ns) {
        sleep_ns = std::min(sleep_ns, std::max<std::int64_t>(*next - port.now_ns(), 0));
      }
      const pty_port::handles handles = port.native_handles();
      waiting.push_back({handles.client, POLLIN, 0});
      waiting.push_back({handles.visitors, POLLIN, 0});
    }
    if (after_each) after_each();
    constexpr std::int64_t unit_ns = 1'000'000'000;
    const timespec sleep{static_cast<std::time_t>(sleep_ns / unit_ns),
                         static_cast<long>(sleep_ns % unit_ns)};
    const int ready =
        ::ppoll(waiting.data(), waiting.size(), sleep_ns == forever_ns ? nullptr : &sleep, nullptr);
    if (ready < 0 && errno != EINTR) {
      return failure(task::reading, problem::system, "poll", errno);
    }
    if (ready > 0 && waiting.front().revents != 0) return {};
  }
}

}  // namespace g4lidar::sim
