// SPDX-License-Identifier: MIT
// A ROS 2 domain: what this program publishes there and reads from there, on networks that come and go.
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

/// Something in the domain, which is opened each time that the domain is created. Made and destroyed by the
/// thread of the bus.
class endpoint {
 public:
  /// The constructor of a derived class ends with bus::add(). `on` outlives it.
  explicit endpoint(bus& on) noexcept : on_(on) {}
  endpoint(const endpoint&) = delete;
  endpoint& operator=(const endpoint&) = delete;
  virtual ~endpoint();

  /// `handle`: that of the bus, for wake(); it outlives the endpoint's entities.
  virtual void open(dds_entity_t participant, int* handle) = 0;
  virtual void close() noexcept = 0;
  /// The topic that it publishes; empty: none.
  [[nodiscard]] virtual std::string_view published() const noexcept { return {}; }

 private:
  bus& on_;
};

/// From a listener whose argument is the handle of a bus: makes it readable.
void wake(void* handle) noexcept;

/// The domain. *Single thread*; endpoints may be used by others.
class bus {
 public:
  /// Without a domain: see update(). Throws bad_value for a network that cannot be configured.
  explicit bus(network wanted);
  bus(const bus&) = delete;
  bus& operator=(const bus&) = delete;
  ~bus();

  /// Opens it now, if the domain is there, and with each new one.
  void add(endpoint& what);
  /// Does so no more. The destructor of an endpoint calls it.
  void remove(const endpoint& what) noexcept;
  /// Creates the domain if there is none, or if the network has changed; to be called about once a
  /// second. What failed is reported once. The first call throws bad_value if CYCLONEDDS_URI is refused.
  void update();
  /// Closes all, so that subscribers learn it at once.
  void close() noexcept;
  [[nodiscard]] bool is_up() const noexcept { return static_cast<bool>(participant_); }

  /// For poll(): readable when a subscriber came or went, or a request came. cleared() ends that.
  [[nodiscard]] int handle() const noexcept { return wake_; }
  void cleared() const noexcept;

 private:
  void open();

  network wanted_;
  int wake_;
  std::vector<endpoint*> endpoints_;
  std::vector<std::string> on_;  // the addresses when the domain was created
  entity domain_;
  entity participant_;
  std::string problem_;  // as it was reported
  bool is_new_ = true;   // no domain was tried yet
};

/// What is published.
struct topic {
  std::string name{};  ///< "/scan"
  const message_type* type = nullptr;
  bool is_reliable = true;
  int depth = 5;             ///< So many messages wait for a slow subscriber.
  bool is_for_late = false;  ///< Those who subscribe later get the last message, too.
};

struct publisher_counts {
  std::uint64_t sent = 0;
  /// Not sent, or replaced by a newer one before every reliable subscriber had acknowledged it.
  std::uint64_t lost = 0;
  std::uint32_t subscribers = 0;  ///< Now.
  std::uint32_t refused = 0;  ///< Subscribers that want a quality of service that is not offered.
};

/// A topic that this program publishes. *Any thread.* Never waits for a subscriber.
class publisher final : public endpoint {
 public:
  publisher(bus& on, topic what);

  void open(dds_entity_t participant, int* handle) override;
  void close() noexcept override;
  [[nodiscard]] std::string_view published() const noexcept override { return what_.name; }

  /// A message in CDR, as the library makes it.
  void publish(g4lidar::bytes message);
  /// Whether anybody reads it: else there is no need to make a message.
  [[nodiscard]] bool is_wanted() const;
  [[nodiscard]] publisher_counts counts() const;

 private:
  void write(g4lidar::bytes message);

  topic what_;
  mutable std::mutex mutex_;
  entity topic_;
  entity writer_;
  const ddsi_sertype* type_ = nullptr;
  std::deque<cdr_message> unread_;  // what the history of the writer keeps, oldest first
  std::vector<std::uint8_t> last_;  // where it is for late subscribers
  publisher_counts counts_;
};

/// The qualities of service of ROS 2 for it. XCDR1, which every ROS 2 reads.
[[nodiscard]] qos qos_of(const topic& what);
/// The name of a topic of ROS 2 in DDS: "rt/scan".
[[nodiscard]] std::string dds_name(std::string_view name);

}  // namespace g4_tool::dds
