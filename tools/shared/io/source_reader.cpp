// SPDX-License-Identifier: MIT
#include "source_reader.hpp"

#include <fmt/format.h>

#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "input.hpp"
#include "output.hpp"

namespace g4_tool {

source_reader::source_reader(const common_options& options, const lidar_options& how,
                             reader_listener& listener, const reader_options& wanted)
    : options_(options),
      listener_(listener),
      reader_(
          [&] {
            lidar_options made = options_for(options, how);
            made.wrap = [this, inner = std::move(made.wrap)](std::unique_ptr<connector> from) {
              simulation_ = simulation_of(*from);
              auto tapped = inner ? inner(std::move(from))
                                  : result<std::unique_ptr<connector>>(std::move(from));
              if (tapped) tapped = diagnosis_.observe(std::move(*tapped));
              return tapped;
            };
            return made;
          }(),
          wanted, this) {}

reader_state source_reader::state() const {
  const reader_state now = reader_.status().state;
  const std::lock_guard lock(mutex_);
  return now == reader_state::ended ? handled_ : now;
}

std::string source_reader::why() const {
  const std::lock_guard lock(mutex_);
  return why_;
}

std::exception_ptr source_reader::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

template <class Call>
void source_reader::guard(Call call) noexcept {
  if (failure()) return;
  try {
    call();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

void source_reader::on_open(g4lidar::lidar& device) {
  guard([&] {
    logger::verbose(fmt::format("opened {}\n", device.name()));
    listener_.on_open(device);
  });
}
void source_reader::on_scan(const scan& found) {
  guard([&] { listener_.on_scan(found); });
}
void source_reader::on_points(std::span<const point> found) {
  guard([&] { listener_.on_points(found); });
}
void source_reader::on_event(const lidar_event& what) {
  diagnosis_.add(what);
  guard([&] { listener_.on_event(what); });
}

void source_reader::on_state(reader_state state, const std::optional<error>& why) {
  guard([&] {
    const auto failed = why ? failure_after(*why) : std::nullopt;
    if (failed && state != reader_state::lost && why->doing() == task::reading)
      diagnosis_.add(*why);
    const std::string text = failed ? failed->what() : "";
    {
      const std::lock_guard lock(mutex_);
      why_ = text;
    }
    if (!text.empty()) logger::verbose(text + '\n');
    listener_.on_state(state, why);
    const std::lock_guard lock(mutex_);
    if (failed && state == reader_state::ended) failure_ = std::make_exception_ptr(*failed);
  });
  const std::lock_guard lock(mutex_);
  handled_ = state;
}

std::optional<g4_tool::failure> source_reader::failure_after(const error& why) const {
  const source_kind kind = kind_of_source(options_.source);
  const bool is_file = kind == source_kind::recording || kind == source_kind::raw_bytes;
  if (why == problem::cancelled) return std::nullopt;
  if (why != problem::end_of_input || !is_file) return failure_of(options_, why);
  const lidar_counts counts = reader_.counts();
  if (counts.stream.packets > 0) return std::nullopt;
  return without_packets(counts.stream, counts.bytes, beginning_of(path_of_source(options_.source)),
                         in_quotes(options_.source));
}

}  // namespace g4_tool
