// SPDX-License-Identifier: MIT
#include "link_monitor.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "discovery/lidar_search.hpp"
#include "stream_tally.hpp"

namespace g4lidar {
namespace {

/// The wait for a second reply.
constexpr std::int64_t second_answer_ns = 35 * ms;
/// The wait for the right reply after a wrong one.
constexpr std::int64_t after_wrong_ns = 250 * ms;
/// After a stop, a link without bytes for this time is quiet.
constexpr std::int64_t quiet_ns = 70 * ms;
/// A device that has not stopped by then gets another stop.
constexpr std::int64_t stop_ns = 500 * ms;
/// The number of consecutive characters of a boot text, with the end of a line among them.
constexpr std::size_t text_size = 16;

/// What words consist of: three quarters of a text, and a quarter of the printable bytes of samples.
bool is_of_word(std::uint8_t byte) noexcept {
  const unsigned lower = byte | 0x20U;
  return (lower >= 'a' && lower <= 'z') || (byte >= '0' && byte <= '9') || byte == ' ';
}

}  // namespace

void event_splitter::take(bytes data, std::int64_t arrival_ns, const observer& to) {
  received(data);
  input_.feed(data, arrival_ns);
  give_all(to);
}

void event_splitter::finish(const observer& to) {
  input_.cut();
  give_all(to);
}

void event_splitter::give_all(const observer& to) {
  while (const event* const found = input_.next()) give(*found, to);
}

void event_splitter::received(bytes data) {
  raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(raw_begin_));
  raw_begin_ = 0;
  raw_.insert(raw_.end(), data.begin(), data.end());
}

void event_splitter::give(const event& found, const observer& to) {
  const std::size_t size = std::min(size_of(found), raw_.size() - raw_begin_);
  const bytes raw = bytes(raw_).subspan(raw_begin_, size);
  raw_begin_ += size;
  const auto* gone = std::get_if<skipped>(&found);
  if (gone != nullptr && gone->reason == skip_reason::noise) {
    look_for_text(raw);
  } else {
    text_ = {};
  }
  counts_.add(found);
  if (to.event) to.event({found, raw, input_.arrival_ns()});
}

// A text stands by itself: it begins behind a packet, a response or a line end, never in the middle of other bytes, as
// the samples of a packet do that another model has sent.
void event_splitter::look_for_text(bytes raw) {
  for (const std::uint8_t byte : raw) {
    const bool is_end = byte == '\r' || byte == '\n';
    if (!is_end && (byte < 0x20 || byte >= 0x7F)) {
      text_ = {.is_spoiled = true};
      continue;
    }
    if (text_.is_spoiled) {
      text_.is_spoiled = !is_end;
      continue;
    }
    ++text_.size;
    text_.words += is_of_word(byte) ? 1U : 0U;
    text_.has_end = text_.has_end || is_end;
    const bool is_text = text_.size >= text_size && text_.has_end &&
                         4 * text_.words >= 3 * (text_.size - 2) && !text_.is_counted;
    if (is_text) ++boots_;
    text_.is_counted = text_.is_counted || is_text;
  }
}

link_monitor::link_monitor(std::unique_ptr<transport> opened, std::function<bool()> is_cancelled,
                           const model& model, bool is_mute)
    : transport_(std::move(opened)),
      is_cancelled_(std::move(is_cancelled)),
      which_(&model),
      is_mute_(is_mute),
      splitter_(model.samples),
      link_(splitter_.input(), transport_.get(), {.quiet_ns = quiet_ns, .drain_ns = stop_ns},
            usual_cut_off_ns) {}

// A wait that is too long is not caused by the device: this program was suspended.
void link_monitor::listen(const std::int64_t& until_ns, const observer& to) {
  const auto take = [&](const received& got, std::int64_t took_ns) {
    timed_read what{got.count, got.arrival_ns};
    if (took_ns > longest_read_ns + host_pause_after_ns) {
      what.host_pause_ns = took_ns;
      ++host_pauses_;
      if (took_ns >= arrival_statistics::stall_ns) host_paused_ns_ = read_ns_;
      has_backlog_ = true;
    }
    if (got.count == 0) {
      has_backlog_ = false;
      silence_ns_ += std::min(took_ns, longest_read_ns);
      return;
    }
    const bytes data = bytes(buffer_).first(got.count);
    what.silence_ns = std::exchange(silence_ns_, 0);
    what.is_backlog = has_backlog_;
    has_backlog_ = has_backlog_ && got.count == buffer_.size();
    if (to.arrival) to.arrival(what);
    survey_.received(data);
    splitter_.received(data);
  };
  if (read_ns_ < 0) read_ns_ = now_ns();
  for (std::int64_t begin_ns = now_ns(); !is_over(); begin_ns = read_ns_) {
    cancelled_ = is_cancelled_ && is_cancelled_();
    if (cancelled_ || begin_ns >= until_ns) return;
    const auto got = link_.receive(buffer_, std::min(until_ns, begin_ns + longest_read_ns));
    const std::int64_t before_ns = std::exchange(read_ns_, now_ns());
    if (got) {
      take(*got, read_ns_ - before_ns);
    } else if (got.error().code() != problem::cancelled) {
      error_ = got.error();
      splitter_.input().cut();
    }
    link_.events(splitter_.sink(to));
  }
}

void link_monitor::listen_for_quiet(std::int64_t quiet, std::int64_t until_ns) {
  while (!is_over() && now_ns() < until_ns) {
    listen(std::min(now_ns() + quiet, until_ns), {});
    if (now_ns() >= heard_ns() + quiet) return link_.finish(splitter_.sink({}));
  }
}

result<void> link_monitor::write(bytes data) {
  if (is_over() || is_mute_) return {};
  survey_.sent(data);
  const auto sent = transport_->write(data, transport_->now_ns() + 500 * ms);
  if (!sent && sent.error().code() != problem::cancelled) error_ = sent.error();
  return {};
}

bool link_monitor::stop() {
  session& talk = link_.talk();
  talk.reset();
  static_cast<void>(talk.begin(requests::stop(), now_ns()));
  std::optional<outcome> done;
  while (!is_over() && !done) {
    static_cast<void>(link_.send([this](bytes out) { return write(out); }));
    std::int64_t until_ns = talk.next_look_ns();
    listen(until_ns, {.event = [&](const auto& /*found*/) { until_ns = talk.next_look_ns(); }});
    talk.look(now_ns());
    done = talk.finished();
  }
  // The session counts events only: the beginning of a last packet may have arrived later.
  if (now_ns() < heard_ns() + quiet_ns) listen_for_quiet(quiet_ns, now_ns() + stop_ns);
  const bool is_quiet = now_ns() >= heard_ns() + quiet_ns;  // also without noise
  if (is_quiet) link_.finish(splitter_.sink({}));
  for (const command code : {command::forced_stop, command::stop}) {
    if (error_) static_cast<void>(transport_->write(encode(code), transport_->now_ns() + 100 * ms));
  }
  return done && done->how == verdict::answered && is_quiet;
}

exchange link_monitor::ask(command code, std::int64_t patience_ns) {
  exchange made{.asked = code};
  send(code);
  made.asked_ns = now_ns();
  await(made, patience_ns);
  return made;
}

// The channel decides which reply belongs to the command. Its repetitions are not used, because
// losses are measured here.
void link_monitor::await(exchange& made, std::int64_t patience_ns) {
  command_channel channel{session_times{}};
  channel.ask(made.asked, true, now_ns());
  static_cast<void>(channel.to_send());  // it was sent before
  const stream_counts before = counts();
  const std::uint64_t boots_before = boots();
  const std::uint64_t pauses_before = host_pauses_;
  std::int64_t until_ns = now_ns() + patience_ns;
  observer to;
  to.event = [&](const observed_event& observed) {
    const channel_state state = channel.take(observed.what, observed.arrival_ns);
    const auto* response = std::get_if<response_view>(&observed.what);
    if (response == nullptr) return;
    if (state != channel_state::answered) {
      ++made.wrong;
      until_ns = std::min(until_ns, observed.arrival_ns + after_wrong_ns);
    } else if (made.is_answered()) {
      ++made.copies;
    } else {
      made.answered_ns = observed.arrival_ns;
      made.reply.assign(response->data().begin(), response->data().end());
      until_ns = std::min(until_ns, observed.arrival_ns + second_answer_ns);
    }
  };
  listen(until_ns, to);
  link_.finish(splitter_.sink(to));
  made.packets += counts().packets - before.packets;
  made.skipped += counts().skipped_bytes() - before.skipped_bytes();
  made.is_disturbed |= boots() != boots_before || host_pauses_ != pauses_before;
}

void link_monitor::read_as(const model& model) {
  sample_bytes_ = sample_bytes();
  which_ = &model;
  boots_before_ += splitter_.boots();
  splitter_ = event_splitter(model.samples);
  survey_.part();
  silence_ns_ = 0;
  read_ns_ = -1;
}

result<recognised_lidar> link_monitor::search(const search_options& known, std::int64_t time_ns) {
  searched_ = {};
  const std::uint32_t before = transport_->baud();
  std::vector<std::pair<std::uint32_t, std::int64_t>> questions;  // rate and time
  const search_observer to{
      .received =
          [&](bytes data, std::int64_t took_ns) {
            if (took_ns > longest_read_ns + host_pause_after_ns) ++host_pauses_;
            searched_.bytes += data.size();
            if (questions.empty()) searched_.unasked += data.size();
            splitter_.take(data, now_ns(), {});
          },
      .asked = [&](std::uint32_t baud) { questions.emplace_back(baud, now_ns()); }};
  lidar_search search(*transport_, known, to);
  auto found = search.run(now_ns() + time_ns);
  if (const stream_survey* const other = search.other()) searched_.other = *other;
  searched_.counts = counts();
  const std::uint32_t its_baud = found ? transport_->baud() : before;
  const auto is_there = [its_baud](const auto& each) { return each.first == its_baud; };
  const auto first = std::ranges::find_if(questions, is_there);
  const bool is_open = !found || std::ranges::count_if(questions, is_there) > 1;
  if (is_open && first != questions.end()) searched_.asked_ns = first->second;
  const bool is_lost =
      !found && (found.error() == problem::gone || found.error() == problem::system ||
                 found.error() == problem::end_of_input || found.error() == problem::interference);
  if (is_lost) error_ = found.error();
  read_as(*which_);
  if (found && found->was_scanning)
    sample_bytes_ = sample_size(found->candidates.front()->samples.layout);
  return found;
}

bool link_monitor::set_baud(std::uint32_t baud) {
  if (is_over()) return false;
  const auto set = transport_->set_baud(baud);
  if (!set) error_ = set.error();
  read_as(*which_);
  return set.value_or(false);
}

}  // namespace g4lidar
