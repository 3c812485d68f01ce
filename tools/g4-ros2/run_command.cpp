// SPDX-License-Identifier: MIT
#include "run_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include <messages.h>
#include "cli/logger.hpp"

namespace g4_tool {

run_command::run_command(dds::bus& bus, std::string name, std::function<void(bool)> use)
    : endpoint(bus), name_(std::move(name)), use_(std::move(use)) {
  bus.add(*this);
}

void run_command::open(dds_entity_t participant, int* handle) {
  const dds::qos quality = dds::qos_of({.type = &dds::bool_message, .depth = 10});
  const std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)> listener(
      dds_create_listener(handle), dds_delete_listener);
  dds_lset_data_available(listener.get(), [](dds_entity_t, void* context) { dds::wake(context); });
  topic_ = dds::entity(dds_create_topic(participant, dds::bool_message.descriptor,
                                        dds::dds_name(name_).c_str(), nullptr, nullptr));
  reader_ =
      dds::entity(dds_create_reader(participant, topic_.get(), quality.get(), listener.get()));
  if (!reader_) logger::info(fmt::format("cannot subscribe to {}\n", name_));
}

void run_command::close() noexcept {
  reader_ = {};
  topic_ = {};
}

void run_command::update() {
  dds::take_all(reader_, [this](const void* sample, const dds_sample_info_t& about) {
    if (!about.valid_data) return;
    const bool runs = static_cast<const std_msgs_msg_dds__Bool_*>(sample)->data;
    logger::info(fmt::format("{}: {}\n", name_, runs ? "true" : "false"));
    use_(runs);
  });
}

}  // namespace g4_tool
