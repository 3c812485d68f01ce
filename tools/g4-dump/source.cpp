// SPDX-License-Identifier: MIT
#include "source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "byte_line.hpp"
#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "sim_command.hpp"

namespace g4_dump {
namespace {

namespace sim = g4lidar::sim;

constexpr std::string_view sim_prefix = "sim:";
constexpr std::string_view file_prefix = "file:";

/// The first bytes of every MCAP file.
constexpr std::array<std::uint8_t, 8> mcap_magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

bool file_begins_as_recording(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY);
  if (fd < 0) return false;
  std::array<std::uint8_t, mcap_magic.size()> begin{};
  const ssize_t count = ::read(fd, begin.data(), begin.size());
  ::close(fd);
  return count > 0 && g4_dump::begins_as_recording({begin.data(), static_cast<std::size_t>(count)});
}

/// "a=b&c=d" in pieces, %41 read as A.
std::vector<std::pair<std::string, std::string>> pairs_of(std::string_view query) {
  std::vector<std::pair<std::string, std::string>> pairs;
  while (!query.empty()) {
    const std::string_view piece = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(piece.size() + 1, query.size()));
    const std::size_t equals = std::min(piece.find('='), piece.size());
    std::string value;
    const std::string_view coded = piece.substr(std::min(equals + 1, piece.size()));
    for (std::size_t i = 0; i < coded.size(); ++i) {
      unsigned byte = 0;
      const bool escaped = coded[i] == '%' && i + 2 < coded.size();
      if (escaped &&
          std::from_chars(&coded[i + 1], &coded[i + 1] + 2, byte, 16).ptr == &coded[i + 1] + 2) {
        value += static_cast<char>(byte);
        i += 2;
      } else {
        value += coded[i];
      }
    }
    pairs.emplace_back(piece.substr(0, equals), value);
  }
  return pairs;
}

/// What `sim:?world=...&seed=...&fault=...` asks for.
struct sim_wish {
  std::optional<std::string> world;
  sim::device_options device;
  std::vector<sim::fault> faults;
};

void take_wish(sim_wish& wish, const std::string& name, const std::string& value) {
  if (name == "world") {
    wish.world = value;
  } else if (name == "seed") {
    wish.device.scanner.seed = whole_number_of(value);
  } else if (name == "serial") {
    if (value.size() != 16 || value.find_first_not_of("0123456789") != std::string::npos) {
      throw bad_value(fmt::format("sim: serial '{}' has not 16 digits", value));
    }
    std::copy(value.begin(), value.end(), wish.device.info.serial_digits.begin());
  } else if (name == "model") {
    wish.device.info.model = number_of(value, std::uint8_t{0}, std::uint8_t{255});
  } else if (name == "fault") {
    const auto read = sim::parse_fault(value);
    if (const auto* wrong = std::get_if<sim::fault_error>(&read)) {
      throw bad_value(fmt::format("sim: fault {}: {}", value, wrong->message));
    }
    wish.faults.push_back(std::get<sim::fault>(read));
  } else {
    throw bad_value(fmt::format("sim: '{}' is none of fault, model, seed, serial, world", name));
  }
}

sim_wish wish_of(std::string_view source) {
  source.remove_prefix(sim_prefix.size());
  if (source.starts_with('?')) source.remove_prefix(1);
  sim_wish wish;
  for (const auto& [name, value] : pairs_of(source)) take_wish(wish, name, value);
  return wish;
}

/// Waits for half a second, or for a signal.
void pause_before_next_try() {
  pollfd bell{interrupt_handle(), POLLIN, 0};
  ::poll(&bell, 1, 500);
  if (interrupt() != 0) throw interrupted();
}

bool may_still_come(const g4lidar::error& why) {
  using enum g4lidar::problem;
  return why.what() == no_port || why.what() == silence || why.what() == gone ||
         why.what() == cannot_connect || why.what() == garbage || why.what() == busy;
}

using any_line = g4lidar::result<std::unique_ptr<g4lidar::connector>>;

any_line line_for(source_kind kind, const g4lidar::lidar_options& how, const opening& wish) {
  switch (kind) {
    case source_kind::recording:
      return g4lidar::replay::open(path_of(how.device), wish.played);
    case source_kind::bytes:
      return open_byte_line(path_of(how.device), wish.bytes_rate_hz);
    default:
      return g4lidar::connector_for(how);
  }
}

/// A word that leads nowhere and is no port's is a file's, most likely; then it is told of as one.
void refuse_unknown_name(const std::string& source, const g4lidar::error& why) {
  const std::string_view name = source;
  if (why.what() != g4lidar::problem::no_port || name.empty() || name.starts_with("/dev/") ||
      name.starts_with("serial:") || name.starts_with("usb:")) {
    return;
  }
  constexpr std::array<std::string_view, 3> files{".mcap", ".bin", ".raw"};
  const bool is_file =
      std::any_of(files.begin(), files.end(), [name](auto end) { return name.ends_with(end); });
  throw failure(is_file ? exit_code::bad_file : exit_code::no_device,
                fmt::format("there is no {} {}. Check the name; g4-dump list shows the ports that "
                            "there are.",
                            is_file ? "file" : "port and no file", in_quotes(source)),
                name_of(why.what()));
}

}  // namespace

/// A device on a pseudo-terminal, served by a thread of its own, in a directory of its own.
class opened_source::simulation {
 public:
  explicit simulation(const sim_wish& wish) {
    std::string pattern = (std::filesystem::temp_directory_path() / "g4-sim-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw failure(exit_code::bad_file, "cannot make a directory for a simulated G4 in " +
                                             in_quotes(pattern) + ". Set TMPDIR to another place.");
    }
    directory_ = pattern;
    sim_options options;
    options.world = wish.world;
    auto port = sim::background_pty::open(
        sim::device(load_world(options, nullptr), wish.device, wish.faults), path());
    if (!port) throw failure(port.error());
    port_.emplace(std::move(*port));
  }
  simulation(const simulation&) = delete;
  simulation& operator=(const simulation&) = delete;
  ~simulation() {
    port_.reset();
    std::error_code unimportant;
    std::filesystem::remove_all(directory_, unimportant);
  }

  [[nodiscard]] std::string path() const { return (directory_ / "g4").string(); }

 private:
  std::filesystem::path directory_;
  std::optional<sim::background_pty> port_;
};

simulated_port serve_simulated(const std::string& source) {
  auto served = std::make_shared<opened_source::simulation>(wish_of(source));
  return {served->path(), served};
}

bool begins_as_recording(std::span<const std::uint8_t> bytes) noexcept {
  return bytes.size() >= mcap_magic.size() &&
         std::equal(mcap_magic.begin(), mcap_magic.end(), bytes.begin());
}

source_kind kind_of(const std::string& source) {
  const std::string_view name = source;
  if (name == "-") return source_kind::bytes;
  if (name.starts_with(sim_prefix)) return source_kind::simulated;
  const std::string path =
      name.starts_with(file_prefix) ? source.substr(file_prefix.size()) : source;
  struct stat status{};
  if (path.empty() || ::stat(path.c_str(), &status) != 0 || S_ISCHR(status.st_mode)) {
    return name.starts_with(file_prefix) ? source_kind::bytes : source_kind::device;
  }
  if (S_ISREG(status.st_mode) && file_begins_as_recording(path)) return source_kind::recording;
  return source_kind::bytes;
}

std::string path_of(const std::string& source) {
  return source.starts_with(file_prefix) ? source.substr(file_prefix.size()) : source;
}

opened_source::opened_source(const common_options& options, g4lidar::lidar_options how,
                             const line_wrapper& wrap) {
  opening wish;
  wish.how = std::move(how);
  if (wrap) wish.tap = [&wrap](auto line) -> any_line { return wrap(std::move(line)); };
  open(options, wish);
}

opened_source::opened_source(const common_options& options, const opening& wish) {
  open(options, wish);
}

void opened_source::open(const common_options& options, const opening& wish) {
  g4lidar::lidar_options how = wish.how;
  how.device = options.source;
  how.baud = options.baud;
  how.reconnect = options.on_loss != loss_rule::exit;
  const source_kind kind = kind_of(options.source);
  if (kind == source_kind::simulated) {
    simulation_ = std::make_unique<simulation>(wish_of(options.source));
    how.device = simulation_->path();
  }
  while (true) {
    auto line = line_for(kind, how, wish);
    if (line) played_ = g4lidar::replay::reader_of(**line);
    if (line && wish.tap) line = wish.tap(std::move(*line));
    auto opened = line ? g4lidar::lidar::open(std::move(*line), how) : tl::unexpected(line.error());
    if (opened) {
      lidar_.emplace(std::move(*opened));
      tell_more(fmt::format("opened {}\n", lidar_->name()));
      return;
    }
    if (options.on_loss != loss_rule::wait || !may_still_come(opened.error())) {
      refuse_unknown_name(options.source, opened.error());
      throw failure(opened.error());
    }
    tell_more(opened.error().message() + "\n");
    pause_before_next_try();
  }
}

opened_source::~opened_source() = default;

}  // namespace g4_dump
