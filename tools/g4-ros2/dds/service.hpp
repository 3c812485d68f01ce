// SPDX-License-Identifier: MIT
// A service of ROS 2, as rmw_cyclonedds has them: a topic of requests and one of replies, whose samples begin with
// the number of the client and of its request.
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

/// How Cyclone DDS knows both types, and the hash of the definition of the service. Valid forever.
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

/// Whose request it is.
struct caller {
  request_header header{};
  std::string
      identity{};  ///< What the client's writer and reader have in common; empty: not known.
};

struct service_counts {
  std::uint64_t requests = 0;
  std::uint64_t ignored = 0;  ///< Not valid.
  std::uint64_t replies = 0;
  std::uint64_t lost = 0;  ///< Replies that could not be sent.
};

/// A reply as the C structure of its type, with all that it refers to.
using reply = std::shared_ptr<void>;

class service final : public endpoint {
 public:
  /// Answers by send(), now or later; false: the request is not valid, and gets no answer. `request`: the C structure
  /// of the type.
  using handler = std::function<bool(const void* request, const caller& from)>;

  /// `name`: "/g4lidar/start".
  service(bus& on, std::string name, const service_type& type, handler handles);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;

  /// Handles what came, and sends what is ready. To be called when the bus is readable, and several times a second.
  void update();
  /// Replies with the next update(). *Any thread.*
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
