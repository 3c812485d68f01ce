// SPDX-License-Identifier: MIT
#include "service.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <utility>

#include "cli/logger.hpp"

namespace g4_tool::dds {
namespace {

using namespace std::chrono_literals;

/// The number of requests that can wait, as in ROS 2.
constexpr int depth = 10;
/// The largest number of replies that wait for the readers of their clients, and the longest wait.
constexpr std::size_t most_waiting = 64;
constexpr auto longest_wait = 1s;

/// A random text, different for each service.
std::string unique_text() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

/// The common key of the writer and the reader of a client: the one that rmw_cyclonedds sets, else their participant.
std::string identity_of(const dds_builtintopic_endpoint_t& of) {
  void* data = nullptr;
  std::size_t size = 0;
  std::string user;
  if (of.qos != nullptr && dds_qget_userdata(of.qos, &data, &size) && data != nullptr) {
    user.assign(static_cast<const char*>(data), size);
  }
  dds_free(data);
  if (const std::size_t at = user.find("clientid="); at != std::string::npos) {
    return user.substr(at, user.find(';', at) - at);
  }
  const std::span<const std::uint8_t> key(of.participant_key.v);
  return {key.begin(), key.end()};
}

using endpoint_data =
    std::unique_ptr<dds_builtintopic_endpoint_t, void (*)(dds_builtintopic_endpoint_t*)>;

std::string identity_of(const endpoint_data& found) {
  return found ? identity_of(*found) : std::string();
}

/// Whether requests of the middleware of a client have another form: the first two bytes are those of its vendor.
bool has_other_form(const endpoint_data& client) {
  constexpr std::array<std::pair<int, int>, 2> others{{{1, 1}, {1, 15}}};  // Connext, Fast DDS
  if (!client) return false;
  const std::pair<int, int> vendor{client->participant_key.v[0], client->participant_key.v[1]};
  return std::ranges::find(others, vendor) != others.end();
}

/// Whether `writer` has discovered the client's reader, without which the reply would be lost.
bool has_reader(dds_entity_t writer, const std::string& identity) {
  if (identity.empty()) return true;
  std::array<dds_instance_handle_t, 256> readers{};
  const dds_return_t count = dds_get_matched_subscriptions(writer, readers.data(), readers.size());
  const auto known = static_cast<std::size_t>(std::max(count, 0));
  if (known > readers.size()) return true;  // too many to compare
  return std::ranges::any_of(std::span(readers).first(known), [&](dds_instance_handle_t each) {
    return identity_of(endpoint_data(dds_get_matched_subscription_data(writer, each),
                                     dds_builtintopic_free_endpoint)) == identity;
  });
}

}  // namespace

service::service(bus& on, std::string name, const service_type& type, handler handles)
    : endpoint(on), name_(std::move(name)), type_(type), handles_(std::move(handles)) {
  on.add(*this);
}

void service::open(dds_entity_t participant, int* handle) {
  const message_type hashed{type_.request, type_.hash};
  const qos quality = qos_of({.type = &hashed, .depth = depth});
  const std::string words =
      fmt::format("serviceid={};typehash=RIHS01_{};", unique_text(), type_.hash);
  dds_qset_userdata(quality.get(), words.data(), words.size());
  const std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)> listener(
      dds_create_listener(handle), dds_delete_listener);
  dds_lset_data_available(listener.get(), [](dds_entity_t, void* with) { wake(with); });
  dds_lset_publication_matched(
      listener.get(),
      [](dds_entity_t, const dds_publication_matched_status_t, void* with) { wake(with); });
  request_topic_ = entity(dds_create_topic(participant, type_.request,
                                           ("rq" + name_ + "Request").c_str(), nullptr, nullptr));
  reply_topic_ = entity(dds_create_topic(participant, type_.reply, ("rr" + name_ + "Reply").c_str(),
                                         nullptr, nullptr));
  writer_ =
      entity(dds_create_writer(participant, reply_topic_.get(), quality.get(), listener.get()));
  reader_ =
      entity(dds_create_reader(participant, request_topic_.get(), quality.get(), listener.get()));
  if (!reader_ || !writer_) logger::info(fmt::format("cannot offer the service {}\n", name_));
  const std::lock_guard lock(mutex_);
  wake_ = handle;
}

void service::close() noexcept {
  reader_ = {};
  writer_ = {};
  request_topic_ = {};
  reply_topic_ = {};
  const std::lock_guard lock(mutex_);
  waiting_.clear();
}

void service::update() {
  if (!reader_ || !writer_) return;
  take_requests();
  send_replies();
}

void service::take_requests() {
  take_all(reader_, [this](const void* request, const dds_sample_info_t& about) {
    if (!about.valid_data) return;
    const endpoint_data client(
        dds_get_matched_publication_data(reader_.get(), about.publication_handle),
        dds_builtintopic_free_endpoint);
    if (has_other_form(client)) {
      ++counts_.unreadable;
      return;
    }
    ++counts_.requests;
    const caller from{*static_cast<const request_header*>(request), identity_of(client)};
    if (!handles_(request, from)) ++counts_.ignored;
  });
}

void service::send(const caller& to, reply what) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back({to, std::move(what), clock::now() + longest_wait});
  if (wake_ != nullptr) wake(wake_);
}

void service::send_replies() {
  const std::lock_guard lock(mutex_);
  const auto now = clock::now();
  const bool is_full = waiting_.size() > most_waiting;
  std::erase_if(waiting_, [&](const waiting& each) {
    if (!is_full && now < each.latest && !has_reader(writer_.get(), each.to.identity)) return false;
    *static_cast<request_header*>(each.what.get()) = each.to.header;
    const bool is_sent = dds_write(writer_.get(), each.what.get()) == DDS_RETCODE_OK;
    ++(is_sent ? counts_.replies : counts_.lost);
    return true;
  });
}

}  // namespace g4_tool::dds
