// SPDX-License-Identifier: MIT
// A service of ROS 2 in the form of rmw_cyclonedds: a topic of requests and a topic of replies. Their samples begin with
// the numbers of the client and of its request.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "bus.hpp"

namespace g4_tool::dds {

/// The descriptors of both types for Cyclone DDS, and the hash of the definition of the service. Static.
struct service_type {
  const dds_topic_descriptor_t* request;
  const dds_topic_descriptor_t* reply;
  std::string_view hash;
};

/// The first members of all requests and replies.
struct request_header {
  std::uint64_t client;
  std::int64_t number;
};

/// The sender of a request.
struct caller {
  request_header header{};
  std::string identity{};  ///< The common key of the client's writer and reader; empty: unknown.
};

struct service_counts {
  std::uint64_t requests = 0;
  std::uint64_t ignored = 0;     ///< Invalid requests.
  std::uint64_t unreadable = 0;  ///< Of a middleware whose requests have another form.
  std::uint64_t replies = 0;
  std::uint64_t lost = 0;  ///< Replies that could not be sent.
};

/// A reply: the C structure of its type, with all that it refers to.
using reply = std::shared_ptr<void>;

class service final : public endpoint {
 public:
  /// Replies by send(), at once or later. False: the request is invalid and gets no reply. `request`: the C structure
  /// of the type.
  using handler = std::function<bool(const void* request, const caller& from)>;

  /// `name`: "/g4lidar/start".
  service(bus& on, std::string name, const service_type& type, handler handles);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;

  /// Handles requests and sends replies. Call it when the bus is readable, and several times a second.
  void update();
  /// Stores a reply for the next update(). *Any thread.*
  void send(const caller& to, reply what);
  [[nodiscard]] const service_counts& counts() const noexcept { return counts_; }

 private:
  using clock = std::chrono::steady_clock;
  struct waiting {
    caller to;
    reply what;
    clock::time_point latest;
  };
  void take_requests();
  void send_replies();

  std::string name_;
  const service_type& type_;
  handler handles_;
  entity request_topic_;
  entity reply_topic_;
  entity reader_;
  entity writer_;
  service_counts counts_;
  std::mutex mutex_;
  std::vector<waiting> waiting_;
  int* wake_ = nullptr;
};

}  // namespace g4_tool::dds
