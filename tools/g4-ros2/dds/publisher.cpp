// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "bus.hpp"
#include "cdr_message.hpp"
#include "cli/logger.hpp"

namespace g4_tool::dds {

std::string dds_name(std::string_view name) { return "rt" + std::string(name); }

qos qos_of(const topic& what) {
  qos made(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(
      made.get(), what.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_durability(made.get(),
                      what.is_for_late ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(made.get(), DDS_HISTORY_KEEP_LAST, what.depth);
  if (what.is_for_late) {
    dds_qset_durability_service(made.get(), 0, DDS_HISTORY_KEEP_LAST, what.depth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(made.get(), 1, &plain);
  const std::string words = fmt::format("typehash=RIHS01_{};", what.type->hash);
  dds_qset_userdata(made.get(), words.data(), words.size());
  return made;
}

publisher::publisher(bus& bus, topic what) : endpoint(bus), what_(std::move(what)) {
  bus.add(*this);
}

void publisher::open(dds_entity_t participant, int* handle) {
  const std::lock_guard lock(mutex_);
  const qos quality = qos_of(what_);
  const std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)> listener(
      dds_create_listener(handle), dds_delete_listener);
  dds_lset_publication_matched(
      listener.get(),
      [](dds_entity_t, const dds_publication_matched_status_t, void* context) { wake(context); });
  topic_ = entity(dds_create_topic(participant, what_.type->descriptor,
                                   dds_name(what_.name).c_str(), nullptr, nullptr));
  writer_ = entity(dds_create_writer(participant, topic_.get(), quality.get(), listener.get()));
  type_ = type_in(participant, *what_.type);
  if (!writer_ || type_ == nullptr)
    return logger::info(fmt::format("cannot publish {}\n", what_.name));
  if (!last_.empty()) write(last_);
}

void publisher::close() noexcept {
  const std::lock_guard lock(mutex_);
  unread_.clear();
  writer_ = {};
  topic_ = {};
}

void publisher::publish(g4lidar::bytes message) {
  const std::lock_guard lock(mutex_);
  if (what_.is_for_late) last_.assign(message.begin(), message.end());
  if (writer_) write(message);
}

void publisher::write(g4lidar::bytes message) {
  while (!unread_.empty() && !is_kept(unread_.front())) unread_.pop_front();
  cdr_message made = type_ == nullptr ? nullptr : encoded(*type_, message);
  const bool is_sent = made && write_cdr(writer_.get(), made) == DDS_RETCODE_OK;
  ++(is_sent ? counts_.sent : counts_.lost);
  // Messages for late subscribers stay in the history and do not count as lost.
  if (!is_sent || what_.is_for_late || !is_kept(made)) return;
  unread_.push_back(std::move(made));
  if (unread_.size() <= static_cast<std::size_t>(what_.depth)) return;
  ++counts_.unacknowledged;
  unread_.pop_front();
}

bool publisher::is_wanted() const { return counts().subscribers > 0; }

publisher_counts publisher::counts() const {
  const std::lock_guard lock(mutex_);
  publisher_counts now = counts_;
  dds_publication_matched_status_t matched{};
  dds_offered_incompatible_qos_status_t refused{};
  if (dds_get_publication_matched_status(writer_.get(), &matched) == DDS_RETCODE_OK) {
    now.subscribers = matched.current_count;
  }
  if (dds_get_offered_incompatible_qos_status(writer_.get(), &refused) == DDS_RETCODE_OK) {
    now.refused = refused.total_count;
  }
  return now;
}

}  // namespace g4_tool::dds
