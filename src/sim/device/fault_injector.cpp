// SPDX-License-Identifier: MIT
// Each fault draws from a stream of its own, and only while it is active: an additional fault does
// not change the effects of another one.
#include "sim/exact.hpp"

#include "fault_injector.hpp"

#include <algorithm>

#include "sim/purpose.hpp"

namespace g4lidar::sim {
namespace {

std::uint8_t random_byte(random_stream& random) noexcept {
  return static_cast<std::uint8_t>(random.next() >> 56);
}

constexpr bool looks_at_bytes(fault_kind kind) noexcept {
  using enum fault_kind;
  return kind == flip || kind == drop || kind == insert || kind == burst || kind == baud;
}

}  // namespace

fault_injector::fault_injector(std::span<const fault> faults, std::uint64_t seed) {
  entries_.reserve(faults.size());
  for (const fault& f : faults) {
    const bool for_ever = f.duration_ns >= forever_ns - f.begin_ns;
    entries_.push_back({f, for_ever ? forever_ns : f.begin_ns + f.duration_ns,
                        stream_for(seed, purpose::faults, entries_.size())});
  }
  edge_ns_ = entries_.empty() ? forever_ns : 0;
}

void fault_injector::set_time(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  edge_ns_ = forever_ns;
  on_the_wire_ = false;
  for (entry& e : entries_) {
    e.at_work = e.what.begin_ns <= now_ns && now_ns < e.end_ns;
    if (!e.at_work) e.left = 0;
    on_the_wire_ = on_the_wire_ || (e.at_work && looks_at_bytes(e.what.kind));
    if (e.what.begin_ns > now_ns) edge_ns_ = std::min(edge_ns_, e.what.begin_ns);
    if (e.end_ns > now_ns) edge_ns_ = std::min(edge_ns_, e.end_ns);
  }
}

const fault* fault_injector::find(fault_kind kind) const noexcept {
  for (const entry& e : entries_) {
    if (e.at_work && e.what.kind == kind) return &e.what;
  }
  return nullptr;
}

std::int64_t fault_injector::end_of(fault_kind kind) const noexcept {
  std::int64_t end_ns = 0;
  for (const entry& e : entries_) {
    if (e.at_work && e.what.kind == kind) end_ns = std::max(end_ns, e.end_ns);
  }
  return end_ns;
}

bool fault_injector::begins(fault_kind kind) const noexcept {
  return std::any_of(entries_.begin(), entries_.end(), [&](const entry& e) {
    return e.what.kind == kind && e.what.begin_ns == now_ns_;
  });
}

const fault* fault_injector::strike(fault_kind kind, std::uint8_t code) noexcept {
  const fault* struck = nullptr;
  for (entry& e : entries_) {
    if (!e.at_work || e.what.kind != kind) continue;
    if (code != 0 && e.what.amount != 0 && e.what.amount != code) continue;
    if (e.random.uniform() < e.what.rate) struck = &e.what;
  }
  return struck;
}

std::uint64_t fault_injector::draw(fault_kind kind, std::uint64_t count) noexcept {
  for (entry& e : entries_) {
    if (e.at_work && e.what.kind == kind) return (e.random.next() >> 32) * count >> 32;
  }
  return 0;
}

void fault_injector::damage(entry& rule, passed_byte& passing) noexcept {
  std::uint8_t& last = passing.bytes[passing.count == 2 ? 1 : 0];
  switch (rule.what.kind) {
    case fault_kind::flip:
      if (rule.random.uniform() >= rule.what.rate) return;
      last = static_cast<std::uint8_t>(last ^ 1U << (rule.random.next() >> 61));
      passing.damaged = true;
      return;
    case fault_kind::drop:
      if (rule.random.uniform() >= rule.what.rate) return;
      passing.count = static_cast<std::uint8_t>(passing.count - (passing.count > 0 ? 1U : 0U));
      passing.damaged = true;
      return;
    case fault_kind::insert:
      if (rule.random.uniform() >= rule.what.rate || passing.count != 1) return;
      passing = {{random_byte(rule.random), passing.bytes[0]}, 2, true, passing.damaged};
      return;
    case fault_kind::burst:
      if (rule.left == 0 && rule.random.uniform() < rule.what.rate) rule.left = rule.what.amount;
      if (rule.left == 0) return;
      --rule.left;
      last = random_byte(rule.random);
      passing.damaged = true;
      return;
    default:  // baud: the host samples at the wrong times
      last = random_byte(rule.random);
      if (passing.count > 0 && rule.random.uniform() < 0.4) --passing.count;
      passing.damaged = true;
      return;
  }
}

passed_byte fault_injector::pass(std::uint8_t byte) noexcept {
  passed_byte passing{{byte, 0}, 1};
  if (!on_the_wire_) return passing;
  for (entry& e : entries_) {
    if (e.at_work && looks_at_bytes(e.what.kind)) damage(e, passing);
  }
  return passing;
}

}  // namespace g4lidar::sim
