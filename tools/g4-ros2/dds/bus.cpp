// SPDX-License-Identifier: MIT
#include "bus.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <set>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/verbs.hpp"

namespace g4_tool::dds {
namespace {

/// The number of different lines that are remembered.
constexpr std::size_t most_lines = 100;

/// The log of Cyclone DDS.
struct domain_log {
  std::mutex mutex;
  std::set<std::string> lines;  // that were logged
  bool is_creating = false;     // a domain: its errors are not logged
  std::string trouble;          // the first one of them
};

domain_log& the_log() {
  static domain_log log;
  return log;
}

/// The reason in a line about a configuration, without its place and a full stop; else the line.
std::string_view reason_in(std::string_view line) {
  while (line.ends_with('.')) line.remove_suffix(1);
  constexpr std::string_view of_contents = "config: ";
  if (!line.starts_with(of_contents)) return line;
  line.remove_prefix(of_contents.size());
  return line.substr(0, line.find(" (CYCLONEDDS_URI"));
}

/// Logs each different line once, because failed attempts are repeated.
void log_line(void*, const dds_log_data_t* line) {
  std::string_view text(line->message, line->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.remove_suffix(1);
  const bool is_bad = (line->priority & (DDS_LC_FATAL | DDS_LC_ERROR)) != 0;
  domain_log& log = the_log();
  const std::lock_guard lock(log.mutex);
  if (is_bad && log.is_creating) {
    if (log.trouble.empty()) log.trouble = reason_in(text);
    return;
  }
  if (log.lines.size() > most_lines) log.lines.clear();
  if (!log.lines.emplace(text).second) return;
  const std::string words = fmt::format("Cyclone DDS: {}\n", text);
  is_bad ? logger::info(words) : logger::verbose(words);
}

/// A domain with this configuration; `trouble`: why there is none.
entity created(std::uint32_t number, const std::string& configuration, std::string& trouble) {
  domain_log& log = the_log();
  const auto set = [&log](bool is_creating) {
    const std::lock_guard lock(log.mutex);
    log.is_creating = is_creating;
    return std::exchange(log.trouble, {});
  };
  set(true);
  entity made(dds_create_domain(number, configuration.c_str()));
  trouble = set(false);
  return made;
}

/// Whether enough descriptors for a domain are left. Cyclone DDS crashes without them.
bool has_descriptors() {
  constexpr int needed = 16;
  struct rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return true;
  int found = 0;
  for (int fd = 0; found < needed && static_cast<rlim_t>(fd) < limit.rlim_cur; ++fd) {
    if (::fcntl(fd, F_GETFD) < 0) ++found;
  }
  return found == needed;
}

}  // namespace

void wake(void* handle) noexcept {
  static_cast<void>(::eventfd_write(*static_cast<const int*>(handle), 1));
}

bus::bus(network wanted)
    : wanted_(std::move(wanted)), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  static_cast<void>(configuration(wanted_, true));
  dds_set_log_sink(log_line, nullptr);
}

bus::~bus() {
  close();
  ::close(wake_);
}

void bus::clear() const noexcept {
  eventfd_t count = 0;
  static_cast<void>(::eventfd_read(wake_, &count));
}

void bus::add(endpoint& what) {
  endpoints_.push_back(&what);
  if (is_up()) what.open(participant_.get(), &wake_);
}

void bus::remove(const endpoint& what) noexcept { std::erase(endpoints_, &what); }

endpoint::~endpoint() { bus_.remove(*this); }

void bus::close() noexcept {
  for (endpoint* each : endpoints_) each->close();
  participant_ = {};
  domain_ = {};
}

void bus::update() {
  std::vector<std::string> now = addresses(wanted_.interface);
  if (is_up() && !has_moved(on_, now)) return;
  if (is_up()) {
    logger::info("the network has changed: joining the ROS 2 domain again\n");
    close();
  }
  on_ = std::move(now);
  open();
}

void bus::open() {
  network here = wanted_;
  // Without a network there is no multicast, so the programs of this machine are addressed by unicast.
  if (on_.empty() && here.range == discovery_range::subnet && here.interface.empty()) {
    here.peers.emplace_back("localhost");
  }
  const bool is_possible = has_descriptors();
  std::string trouble;
  const auto create = [&] {
    return created(here.domain, configuration(here, !on_.empty()), trouble);
  };
  if (is_possible) domain_ = create();
  if (is_on_loopback(here)) keep_multicast_here();  // before a participant announces itself
  // Without an enclave ROS 2 does not list the nodes of a participant.
  constexpr std::string_view user_data = "enclave=/;";
  const qos with_enclave(dds_create_qos(), dds_delete_qos);
  dds_qset_userdata(with_enclave.get(), user_data.data(), user_data.size());
  const dds_entity_t made =
      domain_ ? dds_create_participant(wanted_.domain, with_enclave.get(), nullptr)
              : DDS_RETCODE_ERROR;
  participant_ = entity(made);
  if (!participant_) {
    domain_ = {};
    const std::string why = trouble;
    std::string hint;
    if (!is_possible) {
      hint = "Too many files are open. Raise the limit: ulimit -n 1024";
      if (is_new_) {
        throw failure(exit_code::bad_file,
                      fmt::format("cannot join the ROS 2 domain {}. {}.", wanted_.domain, hint));
      }
    } else if (is_new_ && !std::exchange(here.more, {}).empty() && create()) {
      throw bad_value("CYCLONEDDS_URI: " + why + ". Correct that variable, or unset it");
    } else if (!wanted_.interface.empty()) {
      hint = "Is the interface " + wanted_.interface + " there?";
    }
    is_new_ = false;
    if (hint.empty()) hint = why;
    std::string problem = fmt::format("cannot join the ROS 2 domain {} now; trying again{}{}\n",
                                      wanted_.domain, hint.empty() ? "" : ". ", hint);
    if (problem != std::exchange(problem_, problem)) logger::info(problem);
    return;
  }
  std::set<std::string_view> topics;
  for (const endpoint* each : endpoints_) topics.insert(each->published());
  topics.erase("");
  std::string reach(name_of(wanted_.range));
  if (names_interfaces(wanted_.more)) {
    reach += ", the interfaces of CYCLONEDDS_URI";
  } else if (!wanted_.interface.empty()) {
    reach += ", " + wanted_.interface;
  }
  logger::info(fmt::format("joined the ROS 2 domain {} ({}): publishing {}\n", wanted_.domain,
                           reach, fmt::join(topics, ", ")));
  problem_.clear();
  is_new_ = false;
  for (endpoint* each : endpoints_) each->open(made, &wake_);
}

}  // namespace g4_tool::dds
