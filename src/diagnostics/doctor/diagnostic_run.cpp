// SPDX-License-Identifier: MIT
// The way through the stages of a run; of them port, permission and holder: which port, which users
// may open it, and which process has it open.
#include "g4lidar/diagnostics/diagnosis.hpp"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <functional>
#include <span>
#include <string>
#include <utility>

#include "diagnostics/stages.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "g4lidar/transport/source.hpp"
#include "live_run.hpp"
#include "transport/port_holder.hpp"
#include "transport/system_calls.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {
namespace {

/// The rate at which a search begins.
constexpr std::uint32_t searched_first = g4_model.bauds[0];

std::string real_path(const std::string& path) {
  std::array<char, PATH_MAX> real{};
  return ::realpath(path.c_str(), real.data()) == nullptr ? path : std::string(real.data());
}

/// Reports `current` and begins the next stage.
void pass(stage_log& log, stage_report& current) {
  const auto next = static_cast<diagnostic_stage>(static_cast<int>(current.stage) + 1);
  log.report(current);
  current = stage_report{.stage = next};
}

/// Reports the stage with the reason, all stages before it as passed and all after it as skipped.
void report_unopened(stage_log& log, stage_report current, const error& why) {
  const diagnosis what = diagnosis_of(why.code());
  while (current.stage < stage_of(what)) pass(log, current);
  current.find(what);
  current.detail = why.detail();
  current.remark = cause_of(why);
  pass(log, current);
  log.skip_from(current.stage, "Not reached.");
}

/// As select_port(), which writes to ports to find a lidar by its number, or among several.
result<port_info> select_silently(std::string_view source) {
  if (source.starts_with("serial:")) {
    return failure(task::finding, problem::bad_option,
                   std::string(source) + ", which is a question, and nothing is to be sent");
  }
  if (!source.empty()) return select_port(source, {.listen_only = true});
  auto ports = list_ports();
  if (!ports) return tl::unexpected(ports.error());
  std::erase_if(*ports, std::not_fn(is_g4_bridge));
  if (ports->empty()) return select_port(source, {.listen_only = true});
  if (ports->size() == 1) return ports->front();
  std::string paths;
  for (const port_info& each : *ports) paths.append(paths.empty() ? "" : ", ").append(each.path);
  return failure(task::finding, problem::several_ports, paths);
}

/// Reports port, permission and holder, and opens the port. Returns null if that fails; then all
/// further stages are reported as skipped, except the one with the reason.
class port_stages {
 public:
  explicit port_stages(stage_log& log) : log_(log) {}

  std::unique_ptr<transport> connect(const std::string& address) {
    report_.add("address", address);
    auto opened = tcp_port::open(address, {.baud = first_baud(log_.options(), searched_first)});
    if (!opened) return give_up(opened.error());
    pass(log_, report_);
    log_.skip(diagnostic_stage::permission, "A network bridge has none.");
    log_.skip(diagnostic_stage::holder, "A network bridge does not report it.");
    return std::move(*opened);
  }

  std::unique_ptr<transport> open(const std::string& source) {
    auto found = log_.options().listen_only
                     ? select_silently(source)
                     : select_port(source, {.probe_all_ports = log_.options().probe_all_ports});
    if (!found) return give_up(found.error());
    port_info port = std::move(*found);
    if (!look_at_port(port) || !look_at_permission(port.path)) return nullptr;
    const std::string holder = find_holder(port);
    auto opened =
        serial_port::open(port.path, {.baud = first_baud(log_.options(), searched_first)});
    const bool is_refused = !opened && opened.error() == problem::permission;
    if (!is_refused) pass(log_, report_);
    if (!holder.empty()) report_.add("held_by", holder);
    if (!opened) return give_up(opened.error());
    if (!holder.empty() && !is_pty(port.path)) {
      report_.find(diagnosis::interference);
      report_.remark = std::string("Also used by ").append(holder).append(".");
    }
    pass(log_, report_);
    return std::move(*opened);
  }

 private:
  std::unique_ptr<transport> give_up(const error& why) {
    report_unopened(log_, report_, why);
    return nullptr;
  }
  bool give_up(problem code, const std::string& path, int reason,
               error_detail detail = error_detail::usual) {
    return give_up(error(task::opening, code, path, reason, detail)) != nullptr;
  }

  bool look_at_port(port_info& port) {
    report_.add("path", port.path);
    const std::string real = real_path(port.path);
    if (real != port.path) report_.add("leads_to", real);
    if (::access(port.path.c_str(), F_OK) != 0) {
      return give_up(problem::no_port, port.path, ENOENT, error_detail::missing_port);
    }
    struct stat status{};
    const bool is_known = ::stat(port.path.c_str(), &status) == 0;
    if (is_known && (!S_ISCHR(status.st_mode) || is_pty_master(status))) {
      return give_up(problem::not_serial, port.path, ENOTTY);
    }
    if (const auto all = list_ports()) {
      for (const port_info& each : *all) {
        if (each.path == real) port = each;
      }
    }
    if (!port.driver.empty()) report_.add("driver", port.driver);
    if (port.vendor_id != 0) {
      report_.add("usb", usb_id_of(port));
      report_.add("bridge_of_a_g4", is_g4_bridge(port) ? "yes" : "no");
    }
    pass(log_, report_);
    return true;
  }

  /// The stage ends when the port was opened: the system may refuse that for other reasons.
  bool look_at_permission(const std::string& path) {
    struct stat status{};
    if (::stat(path.c_str(), &status) == 0) {
      const passwd* const owner = ::getpwuid(status.st_uid);
      report_.add("owner", owner == nullptr ? std::to_string(status.st_uid) : owner->pw_name);
      const group* const its = ::getgrgid(status.st_gid);
      report_.add("group", its == nullptr ? std::to_string(status.st_gid) : its->gr_name);
      report_.add("mode", digits_of(static_cast<unsigned>(status.st_mode) & 07777U, 8, 4));
    }
    if (::access(path.c_str(), R_OK | W_OK) == 0) return true;
    const int why = errno;
    return give_up(problem::permission, path, why, permission_detail(why));
  }

  // A process has the other end of a pseudo-terminal open, and usually also this one.
  std::string find_holder(const port_info& port) {
    port_info here = port;
    here.path = real_path(port.path);
    find_holders(std::span(&here, 1));
    return here.holder;
  }

  stage_log& log_;
  stage_report report_{};
};

}  // namespace

std::string digits_of(unsigned number, unsigned base, std::size_t count) {
  std::string text(count, '0');
  for (; number > 0 && count > 0; number /= base) text[--count] = "0123456789abcdef"[number % base];
  return text;
}

std::string usb_id_of(const port_info& port) {
  return digits_of(port.vendor_id, 16, 4) + ":" + digits_of(port.product_id, 16, 4);
}

bool is_pty(const std::string& path) { return real_path(path).starts_with("/dev/pts/"); }

std::string cause_of(const error& why) {
  std::string text = why.message();
  text.resize(text.size() - why.advice().size() - 1);
  return text;
}

std::vector<stage_report> diagnose(std::string_view source, const diagnostic_options& options) {
  stage_log log(options);
  std::string device(source);
  std::unique_ptr<connector> simulated;  // outlives the run
  switch (kind_of_source(source)) {
    case source_kind::device:
      device = path_of_source(source);
      break;
    case source_kind::simulated: {
      auto made = connector_for({.device = device});
      const auto port = made ? (*made)->connect() : tl::unexpected(made.error());
      if (!port) {
        report_unopened(log, {}, port.error());
        return std::move(log.stages());
      }
      device = (*port)->name();
      simulated = *std::move(made);
      break;
    }
    case source_kind::recording:
    case source_kind::raw_bytes:
      log.come_by(byte_path::file);
      examine_file(std::string(source), log);
      return std::move(log.stages());
  }
  log.come_from(device);
  port_stages first(log);
  auto opened = is_bridge(device) ? first.connect(device) : first.open(device);
  if (!opened) return std::move(log.stages());
  const bool is_named = !source.empty();
  live_run(std::move(opened), log, is_named).run();
  return std::move(log.stages());
}

std::vector<stage_report> diagnose(std::unique_ptr<transport> opened,
                                   const diagnostic_options& options) {
  stage_log log(options);
  live_run(std::move(opened), log, true).run();
  return std::move(log.stages());
}

std::vector<stage_report> diagnose(connector& connector, const diagnostic_options& options) {
  auto opened = connector.connect();
  if (opened) return diagnose(std::move(*opened), options);
  stage_log log(options);
  report_unopened(log, {}, opened.error());
  return std::move(log.stages());
}

}  // namespace g4lidar
