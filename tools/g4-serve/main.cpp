// SPDX-License-Identifier: MIT
// g4-serve: a lidar in a web page and in Foxglove, from one port.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "cli/logger.hpp"
#include "cli/serve_verb.hpp"
#include "cli/verbs.hpp"
#include "client_registry.hpp"
#include "io/interrupt.hpp"
#include "io/service_watch.hpp"
#include "scan_publisher.hpp"
#include "web_server.hpp"

namespace g4_tool {
namespace {

constexpr const char* description =
    R"(g4-serve shows a lidar, a recording or a simulated lidar in a web page, and to Foxglove, from one
TCP port. It is what g4-dump serve runs.)";

std::string new_session() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

/// All parts of the server.
class lidar_server {
 public:
  lidar_server(const serve_options& options, const std::vector<named_source>& lidars)
      : options_(options),
        registry_(new_session(), options.allows_set,
                  {.set = [this](const set_request& wanted,
                                 auto done) { publisher_.set(wanted, std::move(done)); },
                   .play = [this](const play_request& wanted) { publisher_.play(wanted); },
                   .record = [this](const record_request& wanted,
                                    auto done) { publisher_.record(wanted, std::move(done)); }},
                  [this] { wake(); }),
        publisher_(options, lidars, registry_) {
    server_ =
        std::make_unique<web_server>(options.address, options.port, options.origins, registry_);
    served_ = server_.get();
    urls_ = server_->urls();
  }
  lidar_server(const lidar_server&) = delete;
  lidar_server& operator=(const lidar_server&) = delete;
  ~lidar_server() {
    publisher_.stop();  // the motors first
    served_ = nullptr;
    server_.reset();
  }

  /// Serves until a signal or the end of -d. Throws a failure of the lidar.
  void run() {
    using namespace std::chrono_literals;
    using clock = std::chrono::steady_clock;
    for (const std::string& url : urls_) logger::info(url + '\n');
    publisher_.start();
    time_limits limits(options_.common.duration, std::chrono::nanoseconds(0));
    clock::time_point due = clock::now();
    while (!limits.is_over()) {
      if (wait_for_input(-1, -1, std::min(due, limits.end())) == wake::interrupt) return;
      if (const auto why = publisher_.failure_of_all()) throw failure(*why);
      report(publisher_.tick().state);
      due = std::max(due + 500ms, clock::now());
    }
  }

 private:
  void wake() {
    if (web_server* const server = served_) server->wake();
  }

  void report(reader_state state) {
    if (state != reader_state::opening) watch_.ready();
    watch_.alive();
    watch_.status(fmt::format("{}, {} at {}", name_of(state),
                              counted(registry_.client_count(), "client"), urls_.front()));
  }

  const serve_options options_;
  client_registry registry_;
  scan_publisher publisher_;
  std::unique_ptr<web_server> server_;
  std::atomic<web_server*> served_ = nullptr;
  std::vector<std::string> urls_;
  service_watch watch_;
};

int serve(const serve_options& options) {
  lidar_server(options, shown_sources(options.sources, options.mounts, options.merges)).run();
  return exit_code_now();
}

std::vector<verb> verbs() { return {make_serve_verb("g4-serve", serve)}; }

}  // namespace
}  // namespace g4_tool

int main(int argc, char** argv) {
  const g4_tool::program g4_serve{.name = "g4-serve",
                                  .title = "A lidar in a web page and in Foxglove",
                                  .description = g4_tool::description,
                                  .verbs = g4_tool::verbs,
                                  .default_verb = "g4-serve"};
  return g4_tool::run_program(g4_serve, argc, argv);
}
