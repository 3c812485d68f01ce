// SPDX-License-Identifier: MIT
// A ROS 2 domain and the endpoints of this program in it. The domain follows changes of the network.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "cdr_message.hpp"
#include "entity.hpp"
#include "g4lidar/core/bytes.hpp"
#include "message_type.hpp"
#include "network.hpp"

namespace g4_tool::dds {

class bus;

/// A publisher or subscription, which is opened each time the domain is created. Constructed and
/// destroyed in the thread of the bus.
class endpoint {
 public:
  /// The constructor of a derived class ends with bus::add(). `bus` outlives it.
  explicit endpoint(bus& bus) noexcept : bus_(bus) {}
  endpoint(const endpoint&) = delete;
  endpoint& operator=(const endpoint&) = delete;
  virtual ~endpoint();

  /// `handle`: that of the bus, for wake(); it outlives the endpoint's entities.
  virtual void open(dds_entity_t participant, int* handle) = 0;
  virtual void close() noexcept = 0;
  /// The topic that it publishes; empty if none.
  [[nodiscard]] virtual std::string_view published() const noexcept { return {}; }

 private:
  bus& bus_;
};

/// For listeners whose argument is the handle of a bus: makes the handle readable.
void wake(void* handle) noexcept;

/// The domain. *Single thread*; other threads may use the endpoints.
class bus {
 public:
  /// Does not create the domain: see update(). Throws bad_value for an invalid network.
  explicit bus(network wanted);
  bus(const bus&) = delete;
  bus& operator=(const bus&) = delete;
  ~bus();

  /// Opens an endpoint in the present domain and in each new one.
  void add(endpoint& what);
  /// Ends that. The destructor of an endpoint calls it.
  void remove(const endpoint& what) noexcept;
  /// Creates the domain if there is none, or again if the network has changed. Call it about once a second.
  /// An error is logged once. The first call throws bad_value if CYCLONEDDS_URI is refused.
  void update();
  /// Closes all endpoints and the domain, so that subscribers are informed at once.
  void close() noexcept;
  [[nodiscard]] bool is_up() const noexcept { return static_cast<bool>(participant_); }

  /// For poll(): readable after a change of subscribers or a message, until clear().
  [[nodiscard]] int handle() const noexcept { return wake_; }
  void clear() const noexcept;

 private:
  void open();

  network wanted_;
  int wake_;
  std::vector<endpoint*> endpoints_;
  std::vector<std::string> on_;  // the addresses when the domain was created
  entity domain_;
  entity participant_;
  std::string problem_;  // the last logged one
  bool is_new_ = true;   // before the first attempt to create a domain
};

/// A published topic and its quality of service.
struct topic {
  std::string name{};  ///< "/scan"
  const message_type* type = nullptr;
  bool is_reliable = true;
  int depth = 5;             ///< The number of messages that wait for a slow subscriber.
  bool is_for_late = false;  ///< Later subscribers get the last message.
};

struct publisher_counts {
  std::uint64_t sent = 0;
  std::uint64_t lost = 0;  ///< Not sent.
  /// Replaced by a newer one before every reliable subscriber had acknowledged it. It may have been received.
  std::uint64_t unacknowledged = 0;
  std::uint32_t subscribers = 0;  ///< Now.
  std::uint32_t refused =
      0;  ///< Subscribers that request a quality of service that is not offered.
};

/// Publishes a topic. *Any thread.* Never waits for a subscriber.
class publisher final : public endpoint {
 public:
  publisher(bus& bus, topic what);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;
  [[nodiscard]] std::string_view published() const noexcept override { return what_.name; }

  /// Publishes a message in CDR, as the library encodes it.
  void publish(g4lidar::bytes message);
  /// Whether there are subscribers.
  [[nodiscard]] bool is_wanted() const;
  [[nodiscard]] publisher_counts counts() const;

 private:
  void write(g4lidar::bytes message);

  topic what_;
  mutable std::mutex mutex_;
  entity topic_;
  entity writer_;
  const ddsi_sertype* type_ = nullptr;
  std::deque<cdr_message> unread_;  // the history of the writer, oldest first
  std::vector<std::uint8_t> last_;  // for late subscribers
  publisher_counts counts_;
};

/// The quality of service of ROS 2 for a topic. XCDR1, which every ROS 2 can read.
[[nodiscard]] qos qos_of(const topic& what);
/// The name in DDS of a topic of ROS 2: "rt/scan".
[[nodiscard]] std::string dds_name(std::string_view name);

}  // namespace g4_tool::dds
