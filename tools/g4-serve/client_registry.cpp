// SPDX-License-Identifier: MIT
#include "client_registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace g4_tool {
namespace {

// The slots of a page. Those of Foxglove are the channels.
constexpr std::size_t settings_slot = 0;
constexpr std::size_t status_slot = 1;
constexpr std::size_t scan_slot = 2;

constexpr std::string_view bytes_left_out =
    "this client reads too slowly: messages of /g4lidar/from_device are left out";

outgoing text_of(shared_bytes payload) { return {.payload = std::move(payload)}; }
outgoing text_of(std::string_view text) { return text_of(share(text)); }

}  // namespace

struct client_registry::client {
  client_kind kind;
  void* socket;
  std::uint64_t id;
  outbox waiting{};
  std::array<std::optional<std::uint32_t>, channel_count> subscriptions{};
  bool is_waiting = false;  // its last setting or recording is not finished
};

client_registry::client_registry(std::string_view session, bool allows_set, lidar_actions actions,
                                 std::function<void()> wake)
    : allows_set_(allows_set),
      actions_(std::move(actions)),
      wake_(std::move(wake)),
      server_info_(share(server_info_text(session))),
      advertise_(share(advertise_text())),
      status_(share(status_text({}))) {}

client_registry::~client_registry() = default;

client_registry::client* client_registry::connect(client_kind kind, void* socket) {
  const std::lock_guard lock(mutex_);
  if (clients_.size() >= most_clients) return nullptr;
  client& made = clients_.emplace_back(client{kind, socket, ++last_id_});
  if (kind == client_kind::foxglove) {
    made.waiting.add(text_of(server_info_));
    made.waiting.add(text_of(advertise_));
  } else {
    if (hello_) made.waiting.add(text_of(hello_));
    made.waiting.replace(status_slot, text_of(status_));
  }
  return &made;
}

void client_registry::disconnect(client* gone) {
  const std::lock_guard lock(mutex_);
  clients_.remove_if([gone](const client& each) { return &each == gone; });
}

bool client_registry::receive(client& peer, std::string_view text) {
  return peer.kind == client_kind::page ? receive_page(peer, text) : receive_foxglove(peer, text);
}

bool client_registry::receive_page(client& peer, std::string_view text) {
  const auto request = parse_page_request(text);
  if (!request) return false;
  if (const auto* bad = std::get_if<bad_request>(&*request)) {
    answer(peer.id, bad->of, bad->message);
  } else if (const auto* wanted = std::get_if<set_request>(&*request)) {
    if (!allows_set_) {
      answer(peer.id, "set", "the settings are read-only: start g4-serve with --allow-set");
    } else {
      take_slow(peer, "set", [&](auto done) { actions_.set(*wanted, std::move(done)); });
    }
  } else if (const auto* recording = std::get_if<record_request>(&*request)) {
    take_slow(peer, "record", [&](auto done) { actions_.record(*recording, std::move(done)); });
  } else {
    actions_.play(std::get<play_request>(*request));
  }
  return true;
}

void client_registry::take_slow(
    client& peer, const std::string& op,
    const std::function<void(std::function<void(const std::string&)>)>& act) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(peer.is_waiting, true)) {
      peer.waiting.add(text_of(error_text(op, "the request before it is not done yet")));
      return;
    }
  }
  act([this, op, id = peer.id](const std::string& error) {
    {
      const std::lock_guard lock(mutex_);
      const auto found = std::ranges::find(clients_, id, &client::id);
      if (found != clients_.end()) found->is_waiting = false;
    }
    if (!error.empty()) answer(id, op, error);
  });
}

bool client_registry::receive_foxglove(client& peer, std::string_view text) {
  const auto request = parse_foxglove_request(text);
  if (!request) return false;
  const std::lock_guard lock(mutex_);
  const auto warn = [&peer](const std::string& message) {
    if (!message.empty()) peer.waiting.add(text_of(foxglove_status_text(1, message)));
  };
  if (const auto* wanted = std::get_if<subscribe_request>(&*request)) {
    for (const auto& entry : wanted->entries) warn(subscribe(peer, entry));
  } else if (const auto* unwanted = std::get_if<unsubscribe_request>(&*request)) {
    for (std::size_t i = 0; i < channel_count; ++i) {
      auto& subscription = peer.subscriptions[i];
      if (!subscription || std::ranges::count(unwanted->ids, *subscription) == 0) continue;
      subscription.reset();
      peer.waiting.clear(i);
    }
  } else {
    warn(fmt::format("this server does not know '{}'", std::get<other_request>(*request).op));
  }
  return true;
}

std::string client_registry::subscribe(client& peer, const subscribe_request::entry& wanted) {
  const auto target = channel_of(wanted.channel_id);
  if (!target) return fmt::format("there is no channel {}", wanted.channel_id);
  if (std::ranges::count(peer.subscriptions, wanted.id) > 0) {
    return fmt::format("the subscription {} is there already", wanted.id);
  }
  auto& subscription = peer.subscriptions[static_cast<std::size_t>(*target)];
  if (subscription) return fmt::format("the channel {} is subscribed already", wanted.channel_id);
  subscription = wanted.id;
  return {};
}

std::optional<outgoing> client_registry::take(client& receiver) {
  const std::lock_guard lock(mutex_);
  return receiver.waiting.take();
}

bool client_registry::has_more(const client& receiver) const {
  const std::lock_guard lock(mutex_);
  return !receiver.waiting.is_empty();
}

void client_registry::for_each_ready(const std::function<void(void*)>& use) {
  const std::lock_guard lock(mutex_);
  for (const client& each : clients_) {
    if (!each.waiting.is_empty()) use(each.socket);
  }
}

shared_bytes client_registry::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

client_registry::wanted_messages client_registry::wanted() const {
  wanted_messages all;
  const std::lock_guard lock(mutex_);
  for (const client& each : clients_) {
    all.page = all.page || each.kind == client_kind::page;
    for (std::size_t i = 0; i < channel_count; ++i) {
      all.channels[i] = all.channels[i] || each.subscriptions[i].has_value();
    }
  }
  return all;
}

void client_registry::put_messages(const std::function<void(client&)>& put) {
  {
    const std::lock_guard lock(mutex_);
    for (client& each : clients_) put(each);
  }
  wake_();
}

void client_registry::to_pages(std::size_t slot, bool is_text, const shared_bytes& payload) {
  put_messages([&](client& each) {
    if (each.kind != client_kind::page) return;
    each.waiting.replace(slot, {.is_text = is_text, .payload = payload});
  });
}

void client_registry::answer(std::uint64_t id, std::string_view op, const std::string& message) {
  put_messages([&](client& each) {
    if (each.id == id) each.waiting.add(text_of(error_text(op, message)));
  });
}

void client_registry::send_hello(const std::string& hello, bool sends) {
  {
    const std::lock_guard lock(mutex_);
    hello_ = share(hello);
  }
  if (sends) event(hello);
}

void client_registry::settings(const std::string& text) {
  to_pages(settings_slot, true, share(text));
}

void client_registry::status(const std::string& text) {
  const shared_bytes shared = share(text);
  {
    const std::lock_guard lock(mutex_);
    status_ = shared;
  }
  to_pages(status_slot, true, shared);
}

void client_registry::event(const std::string& text) {
  const shared_bytes shared = share(text);
  put_messages([&](client& each) {
    if (each.kind == client_kind::page) each.waiting.add(text_of(shared));
  });
}

void client_registry::page_scan(std::vector<std::uint8_t> message) {
  to_pages(scan_slot, false, share(std::move(message)));
}

void client_registry::publish(channel target, std::int64_t stamp_ns,
                              std::vector<std::uint8_t> message) {
  const shared_bytes payload = share(std::move(message));
  const auto slot = static_cast<std::size_t>(target);
  put_messages([&](client& each) {
    const auto& subscription = each.subscriptions[slot];
    if (!subscription) return;
    const auto replaced =
        each.waiting.replace(slot, message_data(*subscription, stamp_ns, payload));
    if (target == channel::from_device && replaced == 1) {
      each.waiting.add(text_of(foxglove_status_text(1, bytes_left_out)));
    }
  });
}

std::size_t client_registry::client_count() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

}  // namespace g4_tool
