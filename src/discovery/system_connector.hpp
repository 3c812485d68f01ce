// SPDX-License-Identifier: MIT
// Opens the transports of this computer: serial ports and network bridges.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/discovery.hpp"
#include "g4lidar/transport/transport.hpp"
#include "path_watch.hpp"
#include "port_words.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {

/// Opens the device that lidar_options::device names, repeatedly. It searches a lost lidar at its
/// old path and at every usual USB bridge; the driver identifies it by its number. It opens a
/// port only if the user named its path, or if a lidar may be attached to it: see may_be_ours().
class system_connector final : public connector {
 public:
  /// `named` is the model that the user named, or null. Fails with bad_option if `device` has no known
  /// form.
  [[nodiscard]] static result<std::unique_ptr<connector>> make(std::string_view device,
                                                               std::uint32_t baud,
                                                               const model* named = nullptr);

  /// The same, but what is not named is searched now: the model where `named` is null, and its rate where `baud` is
  /// 0 and the model has several. The open transport is kept for the first connect(), because each opening raises
  /// DTR. Takes up to 5 s where nothing answers or sends. Fails like search(). If the port cannot be opened, the
  /// first connect() fails. `always`: also if there is nothing to be searched but other rates than those of the model.
  /// `probes_all_ports`: find_options::probe_all_ports.
  [[nodiscard]] static result<std::unique_ptr<connector>> find(std::string_view device,
                                                               const search_options& known,
                                                               bool always = false,
                                                               bool probes_all_ports = false);

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override;
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return steady_now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override;
  void wake() noexcept override { waker_.wake(); }
  void refuse() noexcept override;
  [[nodiscard]] int watch() noexcept override;
  [[nodiscard]] bool may_be_back() noexcept override;
  [[nodiscard]] connector_traits traits() const noexcept override {
    recognition known = found_;
    known.model = named_;
    known.candidates = candidates_;
    return {.recognised = known, .is_searched = is_searched_};
  }

 private:
  /// A device node at the time when another lidar answered there. A replug creates the node again.
  struct refused_port {
    std::string path;
    std::uint64_t node;

    friend bool operator==(const refused_port&, const refused_port&) = default;
  };

  system_connector(std::string_view device, std::uint32_t baud, const model* named);

  [[nodiscard]] result<void> search_first(search_options known);
  [[nodiscard]] result<std::unique_ptr<transport>> open_transport();
  [[nodiscard]] result<std::unique_ptr<transport>> first_connect();
  [[nodiscard]] result<std::unique_ptr<transport>> connect_again();
  [[nodiscard]] bool may_be_ours(const port_info& port) const noexcept;
  /// A lidar that does not identify itself can only be known by its USB port.
  [[nodiscard]] bool goes_by_place() const noexcept {
    return named_ != nullptr && named_->link == link_kind::one_way && !first_.bus_path.empty();
  }
  void find_place();
  [[nodiscard]] bool is_refused(const std::string& path) const;
  void list_candidates();
  [[nodiscard]] int watch_handle() const noexcept { return watch_ ? watch_->native_handle() : -1; }

  std::string device_;
  std::uint32_t baud_;
  std::uint32_t named_baud_;  // 0: it is searched
  bool is_searched_ = false;  // the model
  recognition found_;
  bool probes_all_ports_ = false;
  bool only_listens_ = false;
  bool leaves_dtr_ = false;
  const model* named_;                                          // or found
  std::vector<const model*> candidates_;                        // found
  std::optional<result<std::unique_ptr<transport>>> searched_;  // for the first connect()
  port_info first_;                                             // the port of the first connection
  std::vector<std::string> paths_;                              // to be tried in this round
  std::string last_path_;                                       // of the last connection
  std::vector<refused_port> refused_;                           // ports of other lidars
  std::optional<path_watch> watch_;                             // from the first loss on
  waker waker_{real_system_calls()};
};

}  // namespace g4lidar
