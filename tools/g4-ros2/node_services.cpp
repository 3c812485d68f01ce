// SPDX-License-Identifier: MIT
#include "node_services.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

#include "cli/logger.hpp"
#include "service_messages.hpp"

namespace g4_tool {
namespace {

/// Requests with more names are ignored.
constexpr std::size_t most_names = 1000;
/// The largest number of requests to set parameters that wait for lidars.
constexpr std::size_t most_unfinished = 32;

constexpr std::string_view unreadable_advice =
    "a request to a service could not be read: use rmw_cyclonedds_cpp where it is called";

/// Replies with a part for each of `names`, made by `part_of(name, reply)`. `parts_of` selects the member of the message
/// for the parts. False if there are too many names.
template <class Held>
bool reply_to_each(dds::service& via, const dds::caller& from, const auto& names, auto parts_of,
                   auto part_of) {
  if (names._length > most_names) return false;
  const auto held = std::make_shared<Held>();
  for (const char* const name : span_of(names)) held->parts.push_back(part_of(name, *held));
  refer(parts_of(held->message), held->parts);
  via.send(from, as_reply(held));
  return true;
}

/// Whether there are services, which is also logged when the domain is joined.
bool has_services(const ros2_options& options, dds::bus& on) {
  constexpr std::string_view wanted = "rmw_cyclonedds_cpp";
  const std::optional<bool>& chosen = options.transport.has_services;
  const bool is_known = dds::variable("RMW_IMPLEMENTATION") == wanted;
  const bool is_on = chosen.value_or(is_known);
  std::string words = is_on ? "with services" : "without services";
  if (!chosen) {
    words += fmt::format(" (RMW_IMPLEMENTATION is {}{})", is_known ? "" : "not ", wanted);
  }
  on.also_log(words);
  return is_on;
}

}  // namespace

/// Parameters that are being set, and the callback after all have been tried.
struct node_services::set_job {
  std::function<void(const std::vector<std::string>&)> done;  // gets the error of each
  std::mutex mutex{};
  std::vector<std::string> reasons{};
  std::size_t missing = 0;

  void finish(std::size_t index, std::string reason) {
    const std::lock_guard lock(mutex);
    reasons[index] = std::move(reason);
    if (--missing == 0) done(reasons);
  }
};

node_services::node_services(dds::bus& on, const ros2_options& options,
                             std::vector<lidar_node*> lidars)
    : on_(on), options_(options), lidars_(std::move(lidars)) {
  for (lidar_node* const each : lidars_) {
    const std::string prefix = each->name().empty() ? "" : each->name() + ".";
    for (const parameter& one : all_parameters()) {
      targets_.push_back({prefix + std::string(one.name), each, &one});
    }
  }
  if (!has_services(options, on)) return;
  offer("get_parameters", get_type, &node_services::get);
  offer("get_parameter_types", get_types_type, &node_services::get_types);
  offer("list_parameters", list_type, &node_services::list);
  offer("describe_parameters", describe_type, &node_services::describe);
  offer("set_parameters", set_type, &node_services::set);
  offer("set_parameters_atomically", set_atomically_type, &node_services::set_atomically);
  offer("start", trigger_type, &node_services::start);
  offer("stop", trigger_type, &node_services::stop);
}

node_services::~node_services() = default;

void node_services::offer(const std::string& name, const dds::service_type& type,
                          bool (node_services::*handle)(dds::service&, const void*,
                                                        const dds::caller&)) {
  const std::size_t index = services_.size();
  services_.push_back(std::make_unique<dds::service>(
      on_, full_name(options_.name_space, options_.node + "/" + name), type,
      [this, index, handle](const void* request, const dds::caller& from) {
        return (this->*handle)(*services_[index], request, from);
      }));
}

void node_services::update() {
  for (const auto& each : services_) each->update();
  if (!was_advised_ && unreadable() > 0) {
    was_advised_ = true;
    logger::info(std::string(unreadable_advice) + "\n");
  }
}

std::uint64_t node_services::unreadable() const {
  std::uint64_t all = dds::undecoded_requests();
  for (const auto& each : services_) all += each->counts().unreadable;
  return all;
}

diagnostic_status node_services::status() {
  dds::service_counts all{.unreadable = unreadable()};
  for (const auto& each : services_) {
    all.requests += each->counts().requests;
    all.replies += each->counts().replies;
    all.ignored += each->counts().ignored;
    all.lost += each->counts().lost;
  }
  diagnostic_status made{.name = "g4lidar: services",
                         .message = services_.empty() ? "off" : "ok",
                         .values = {{"requests", std::to_string(all.requests)},
                                    {"replies", std::to_string(all.replies)},
                                    {"ignored", std::to_string(all.ignored)},
                                    {"unreadable", std::to_string(all.unreadable)},
                                    {"lost", std::to_string(all.lost)}}};
  if (all.unreadable > std::exchange(unreadable_before_, all.unreadable)) {
    made.level = diagnostic_level::warn;
    made.message = unreadable_advice;
  }
  return made;
}

const node_services::target* node_services::find(std::string_view name) const {
  const auto at = std::ranges::find(targets_, name, &target::name);
  return at == targets_.end() ? nullptr : &*at;
}

bool node_services::get(dds::service& via, const void* request, const dds::caller& from) {
  using held_values = reply_with<rcl_interfaces_srv_dds__GetParameters_Response_,
                                 rcl_interfaces_msg_dds__ParameterValue_>;
  return reply_to_each<held_values>(
      via, from, static_cast<const rcl_interfaces_srv_dds__GetParameters_Request_*>(request)->names,
      [](auto& message) -> auto& { return message.values; },
      [this](const char* name, held_values& held) {
        const target* const known = find(name);
        return message_of(
            known == nullptr ? parameter_value() : known->lidar->parameters().value(*known->what),
            held);
      });
}

bool node_services::get_types(dds::service& via, const void* request, const dds::caller& from) {
  using held_types = reply_with<rcl_interfaces_srv_dds__GetParameterTypes_Response_, std::uint8_t>;
  return reply_to_each<held_types>(
      via, from,
      static_cast<const rcl_interfaces_srv_dds__GetParameterTypes_Request_*>(request)->names,
      [](auto& message) -> auto& { return message.types; },
      [this](const char* name, held_types&) {
        const target* const known = find(name);
        return known == nullptr ? std::uint8_t{0} : known->what->type;
      });
}

bool node_services::list(dds::service& via, const void* request, const dds::caller& from) {
  const auto& wanted =
      *static_cast<const rcl_interfaces_srv_dds__ListParameters_Request_*>(request);
  if (wanted.prefixes._length > most_names) return false;
  const auto held =
      std::make_shared<reply_with<rcl_interfaces_srv_dds__ListParameters_Response_>>();
  std::set<std::string> prefixes;
  const auto asked = span_of(wanted.prefixes);
  for (const target& each : targets_) {
    const bool is_asked = asked.empty() ? is_below(each.name, "", wanted.depth)
                                        : std::ranges::any_of(asked, [&](const char* prefix) {
                                            return is_below(each.name, prefix, wanted.depth);
                                          });
    if (!is_asked) continue;
    held->parts.push_back(held->text(each.name));
    if (const std::size_t dot = each.name.rfind('.'); dot != std::string::npos) {
      prefixes.insert(each.name.substr(0, dot));
    }
  }
  const std::size_t names = held->parts.size();
  for (const std::string& each : prefixes) held->parts.push_back(held->text(each));
  auto& result = held->message.result;
  refer(result.names, held->parts);
  result.prefixes = result.names;
  result.names._length = result.names._maximum = static_cast<std::uint32_t>(names);
  result.prefixes._length = result.prefixes._maximum = static_cast<std::uint32_t>(prefixes.size());
  result.prefixes._buffer += names;
  via.send(from, as_reply(held));
  return true;
}

bool node_services::describe(dds::service& via, const void* request, const dds::caller& from) {
  struct held_ranges : reply_with<rcl_interfaces_srv_dds__DescribeParameters_Response_,
                                  rcl_interfaces_msg_dds__ParameterDescriptor_> {
    std::deque<rcl_interfaces_msg_dds__FloatingPointRange_> ranges;
  };
  return reply_to_each<held_ranges>(
      via, from,
      static_cast<const rcl_interfaces_srv_dds__DescribeParameters_Request_*>(request)->names,
      [](auto& message) -> auto& { return message.descriptors; },
      [this](const char* name, held_ranges& held) {
        const target* const known = find(name);
        rcl_interfaces_msg_dds__ParameterDescriptor_ made{};
        made.name = held.text(name);
        made.description = held.text(known == nullptr ? "" : known->what->description);
        made.additional_constraints = held.text("");
        if (known == nullptr) return made;
        const parameter row = known->lidar->parameters().row(*known->what);
        made.additional_constraints = held.text(row.constraints);
        made.type = row.type;
        made.read_only = row.kind == parameter_kind::read_only;
        if (const auto [least, most, step] = row.range; least < most) {
          made.floating_point_range._buffer = &held.ranges.emplace_back(least, most, step);
          made.floating_point_range._length = made.floating_point_range._maximum = 1;
        }
        return made;
      });
}

bool node_services::set(dds::service& via, const void* request, const dds::caller& from) {
  const auto& wanted = *static_cast<const rcl_interfaces_srv_dds__SetParameters_Request_*>(request);
  const auto parameters = span_of(wanted.parameters);
  if (parameters.size() > most_names) return false;
  const auto answer = [this, &via, from](const std::vector<std::string>& reasons) {
    const auto held = std::make_shared<reply_with<rcl_interfaces_srv_dds__SetParameters_Response_,
                                                  rcl_interfaces_msg_dds__SetParametersResult_>>();
    for (const std::string& each : reasons) {
      held->parts.push_back({each.empty(), held->text(each)});
    }
    refer(held->message.results, held->parts);
    --unfinished_;
    via.send(from, as_reply(held));
  };
  const bool is_busy = unfinished_++ >= most_unfinished;
  const auto job = std::make_shared<set_job>(answer);
  job->reasons.resize(parameters.size());
  job->missing = parameters.size();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const target* const known = find(parameters[i].name);
    if (known == nullptr || is_busy) {
      job->finish(i, is_busy ? "too many requests at once" : "there is no such parameter");
      continue;
    }
    known->lidar->change({{std::string(known->what->name), value_of(parameters[i].value)}},
                         [job, i](std::string reason) { job->finish(i, std::move(reason)); });
  }
  if (parameters.empty()) answer({});
  return true;
}

bool node_services::set_atomically(dds::service& via, const void* request,
                                   const dds::caller& from) {
  const auto& wanted =
      *static_cast<const rcl_interfaces_srv_dds__SetParametersAtomically_Request_*>(request);
  if (wanted.parameters._length > most_names) return false;
  const auto answer = [this, &via, from](const std::string& reason) {
    const auto held =
        std::make_shared<reply_with<rcl_interfaces_srv_dds__SetParametersAtomically_Response_>>();
    held->message.result = {reason.empty(), held->text(reason)};
    --unfinished_;
    via.send(from, as_reply(held));
  };
  std::vector<named_value> values;
  lidar_node* lidar = nullptr;
  std::string reason = unfinished_++ >= most_unfinished ? "too many requests at once" : "";
  for (const auto& each : span_of(wanted.parameters)) {
    const target* const known = find(each.name);
    if (known == nullptr) {
      reason = "there is no such parameter";
    } else if (lidar != nullptr && lidar != known->lidar) {
      reason = "parameters of several lidars cannot be set together";
    } else {
      lidar = known->lidar;
      values.emplace_back(known->what->name, value_of(each.value));
    }
  }
  if (lidar == nullptr || !reason.empty()) {
    answer(reason);
  } else {
    lidar->change(std::move(values), answer);
  }
  return true;
}

bool node_services::start(dds::service& via, const void* /*request*/, const dds::caller& from) {
  return command(via, from, true);
}

bool node_services::stop(dds::service& via, const void* /*request*/, const dds::caller& from) {
  return command(via, from, false);
}

bool node_services::command(dds::service& via, const dds::caller& from, bool runs) {
  std::string words = !runs                 ? "the motor rests until start is called"
                      : options_.is_standby ? "the motor turns while somebody subscribes"
                                            : "the motor turns";
  for (lidar_node* const each : lidars_) {
    each->allow(runs);
    const reader_state state = each->device().state();
    if (state == reader_state::running || state == reader_state::resting) continue;
    words += "; " + (each->name().empty() ? "the lidar" : each->name()) + " is not connected now";
  }
  const auto held = std::make_shared<reply_with<std_srvs_srv_dds__Trigger_Response_>>();
  held->message.success = true;
  held->message.message = held->text(words);
  via.send(from, as_reply(held));
  return true;
}

}  // namespace g4_tool
