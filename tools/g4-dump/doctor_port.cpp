// SPDX-License-Identifier: MIT
#include "doctor_port.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <cstdlib>
#include <span>
#include <utility>

#include "g4lidar/discovery.hpp"
#include "g4lidar/serial_port.hpp"
#include "g4lidar/tcp_port.hpp"
#include "values.hpp"

namespace g4_dump {
namespace {

using g4lidar::problem;

constexpr std::string_view tcp_prefix = "tcp:";

std::string real_path(const std::string& path) {
  std::array<char, PATH_MAX> real{};
  return ::realpath(path.c_str(), real.data()) == nullptr ? path : std::string(real.data());
}

bool is_pty(const std::string& path) { return real_path(path).starts_with("/dev/pts/"); }

/// The stage at which this goes wrong.
stage stage_of(diagnosis what) noexcept {
  switch (what) {
    case diagnosis::permission:
      return stage::permission;
    case diagnosis::busy:
    case diagnosis::interference:
      return stage::holder;
    case diagnosis::bad_baud_rate:
      return stage::baud_rate;
    case diagnosis::silent:
    case diagnosis::deaf:
      return stage::answer;
    case diagnosis::wrong_baud_rate:
      return stage::baud_rate;
    case diagnosis::other_device:
      return stage::identity;
    default:
      return stage::port;
  }
}

class port_examination {
 public:
  explicit port_examination(const std::function<void(const stage_report&)>& tell) : tell_(tell) {}

  std::unique_ptr<g4lidar::transport> connect(const std::string& address, std::uint32_t baud) {
    report_.add("address", address);
    auto opened = g4lidar::tcp_port::open(address, {.baud = baud});
    if (!opened) return give_up(opened.error());
    pass();
    pass("A network bridge has none.", verdict::skipped);
    pass("A network bridge does not tell.", verdict::skipped);
    return std::move(*opened);
  }

  std::unique_ptr<g4lidar::transport> open(const std::string& source, std::uint32_t baud) {
    auto found = g4lidar::select_port(source);
    if (!found) return give_up(found.error());
    g4lidar::port_info port = std::move(*found);
    if (!look_at_port(port)) return nullptr;
    if (!look_at_permission(port.path)) return nullptr;
    std::string holder = look_for_holder(port);
    auto opened = g4lidar::serial_port::open(port.path, {.baud = baud});
    if (!opened) return give_up(opened.error());
    if (!holder.empty() && !is_pty(port.path)) {
      report_.find(diagnosis::interference);
      report_.remark = "Also used by " + holder + ".";
    }
    pass();
    return std::move(*opened);
  }

 private:
  void pass(std::string remark = {}, verdict how = verdict::ok) {
    report_.how = std::max(report_.how, how);
    if (!remark.empty()) report_.remark = std::move(remark);
    tell_(report_);
    const auto next = static_cast<unsigned char>(report_.where) + 1;
    report_ = {};
    report_.where = static_cast<stage>(next);
  }

  /// Tells the stages up to the one that has the reason as well, and all others as skipped.
  std::unique_ptr<g4lidar::transport> give_up(const g4lidar::error& why) {
    const diagnosis what = diagnosis_of(why);
    while (report_.where < stage_of(what)) pass();
    report_.find(what);
    pass(why.message());
    while (static_cast<std::size_t>(report_.where) < stage_count) {
      pass("Not reached.", verdict::skipped);
    }
    return nullptr;
  }
  std::unique_ptr<g4lidar::transport> give_up(problem what, const std::string& subject, int error) {
    return give_up(g4lidar::error(g4lidar::task::opening, what, subject, error));
  }

  bool look_at_port(g4lidar::port_info& port) {
    report_.add("path", port.path);
    if (real_path(port.path) != port.path) report_.add("leads_to", real_path(port.path));
    if (::access(port.path.c_str(), F_OK) != 0) {
      return give_up(problem::no_port, port.path, ENOENT) != nullptr;
    }
    if (const auto all = g4lidar::list_ports()) {
      for (const g4lidar::port_info& each : *all) {
        if (each.path == real_path(port.path)) port = each;
      }
    }
    if (!port.driver.empty()) report_.add("driver", port.driver);
    if (port.vendor_id != 0) {
      report_.add("usb", fmt::format("{:04x}:{:04x}", port.vendor_id, port.product_id));
      report_.add("bridge_of_a_g4", g4lidar::is_g4_bridge(port) ? "yes" : "no");
    }
    pass();
    return true;
  }

  bool look_at_permission(const std::string& path) {
    struct stat status{};
    if (::stat(path.c_str(), &status) == 0) {
      const passwd* const owner = ::getpwuid(status.st_uid);
      report_.add("owner", owner == nullptr ? std::to_string(status.st_uid) : owner->pw_name);
      const group* const its = ::getgrgid(status.st_gid);
      report_.add("group", its == nullptr ? std::to_string(status.st_gid) : its->gr_name);
      report_.add("mode", fmt::format("{:04o}", status.st_mode & 07777U));
    }
    if (::access(path.c_str(), R_OK | W_OK) != 0) {
      return give_up(problem::permission, path, errno) != nullptr;
    }
    pass();
    return true;
  }

  std::string look_for_holder(g4lidar::port_info& port) {
    g4lidar::port_info here = port;
    here.path = real_path(port.path);
    g4lidar::find_holders(std::span(&here, 1));
    // Somebody holds the other end of a pseudo-terminal, and most often this one, too.
    if (!here.holder.empty()) report_.add("holder", here.holder);
    return here.holder;
  }

  const std::function<void(const stage_report&)>& tell_;
  stage_report report_{};
};

}  // namespace

diagnosis diagnosis_of(const g4lidar::error& why) noexcept {
  switch (why.what()) {
    case problem::no_port:
      return diagnosis::no_port;
    case problem::several_ports:
      return diagnosis::several_ports;
    case problem::not_serial:
      return diagnosis::not_serial;
    case problem::cannot_connect:
      return diagnosis::cannot_connect;
    case problem::permission:
      return diagnosis::permission;
    case problem::busy:
      return diagnosis::busy;
    case problem::interference:
      return diagnosis::interference;
    case problem::bad_baud_rate:
      return diagnosis::bad_baud_rate;
    default:
      return diagnosis::system;
  }
}

bool has_baud_rates(const std::string& path) { return path.starts_with('/') && !is_pty(path); }

std::unique_ptr<g4lidar::transport> open_examined(
    const std::string& source, std::uint32_t baud,
    const std::function<void(const stage_report&)>& tell) {
  port_examination exam(tell);
  return source.starts_with(tcp_prefix) ? exam.connect(source, baud) : exam.open(source, baud);
}

}  // namespace g4_dump
