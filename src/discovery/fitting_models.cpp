// SPDX-License-Identifier: MIT
#include "fitting_models.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>

#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// Moves those for which `is_last` is true behind the others; both keep their order. Returns the number of the others.
/// Not std::stable_partition, which uses a deprecated function, as clang reports.
template <class Predicate>
std::size_t move_back(std::vector<const model*>& all, Predicate is_last) {
  std::vector<const model*> last;
  std::ranges::copy_if(all, std::back_inserter(last), is_last);
  std::erase_if(all, is_last);
  const std::size_t others = all.size();
  all.insert(all.end(), last.begin(), last.end());
  return others;
}

bool is_two_way(const model* row) noexcept { return row->link == link_kind::two_way; }

}  // namespace

bool has_rate(const model& row, std::uint32_t baud) noexcept {
  return std::ranges::any_of(rates_of(row),
                             [baud](std::uint32_t own) { return is_tolerable(baud, own); });
}

bool is_surely_another(const model& stated, std::uint8_t number, std::uint32_t baud) noexcept {
  if (number == 0 || stated.has_number(number)) return false;  // 0 is the number of none
  if (stated.link == link_kind::one_way) return one_way_other_than(stated, number) != nullptr;
  return std::ranges::any_of(models, [&](const model& row) {
    return row.has_number(number) && may_send(row, sample_size(stated.samples.layout), false) &&
           (baud == 0 || has_rate(row, baud));
  });
}

std::vector<const model*> models_that_fit(const lidar_signs& seen) {
  const auto all_with = [&seen](bool by_rate, bool by_ct) {
    std::vector<const model*> found;
    for (const model& row : models) {
      if (seen.answers == presence::yes && row.link != link_kind::two_way) continue;
      if (seen.answers == presence::no && row.link != link_kind::one_way) continue;
      if (seen.id != 0 && !row.has_number(seen.id)) continue;
      if (!may_send(row, seen.sample_bytes, false)) continue;
      if (by_rate && seen.baud != 0 && !has_rate(row, seen.baud)) continue;
      if (by_ct && seen.ct_id_low_bits != 0 &&
          (row.ct_information == presence::no || !detail::may_report(row, seen.ct_id_low_bits))) {
        continue;
      }
      found.push_back(&row);
    }
    return found;
  };
  const auto is_far_off = [&seen](const model* row) { return !may_measure(*row, seen); };
  // A number does not need an uncertain rate.
  std::vector<const model*> found = all_with(seen.is_baud_certain || seen.id == 0, true);
  const bool is_stated = seen.id != 0 || seen.ct_id_low_bits != 0;
  const bool is_variant =
      std::ranges::none_of(models, [&seen](const model& row) { return has_rate(row, seen.baud); });
  const bool is_other = !seen.is_baud_certain && std::ranges::all_of(found, is_far_off);
  if (is_other || (found.empty() && (is_stated || is_variant))) {
    auto others = all_with(false, true);
    std::erase_if(others, is_far_off);
    if (found.empty() || !others.empty()) found = std::move(others);
  }
  if (found.empty()) found = all_with(true, false);
  // Where the rate does not decide, those whose usual number it is come first.
  const auto has_other = [&seen](const model* row) { return row->ids[0] != seen.id; };
  if (seen.id != 0) static_cast<void>(move_back(found, has_other));
  // A sample rate decides between models with one each; within a tenth they are equal.
  const std::size_t near_count = move_back(found, is_far_off);
  const std::span near(found.begin(), near_count == 0 ? found.size() : near_count);
  const auto is_near = [near](const model& row) {
    return std::ranges::find(near, &row) != near.end();
  };
  const model* const usual = usual_model(is_near, usual_kind::at_its_rate);
  const auto first = std::ranges::find(near, usual);
  const bool is_usual = usual != nullptr && usual->usual >= usual_kind::at_its_rate;
  if (is_usual) std::rotate(near.begin(), first, first + 1);
  return found;
}

std::vector<const model*> models_at_rate(const lidar_signs& seen) {
  auto all = models_that_fit(seen);
  const auto is_far_off = [&seen](const model* row) { return !may_measure(*row, seen); };
  if (!std::ranges::all_of(all, is_far_off)) std::erase_if(all, is_far_off);
  return all;
}

std::vector<const model*> models_of_size(const lidar_signs& seen) {
  lidar_signs known{.sample_bytes = seen.sample_bytes,
                    .sample_rate_hz = seen.sample_rate_hz,
                    .frequency_chz = seen.frequency_chz,
                    .answers = seen.answers};
  auto all = models_at_rate(known);
  if (!all.empty()) return all;
  known.answers = presence::unknown;
  return models_at_rate(known);
}

std::vector<const model*> models_of_answer(lidar_signs seen, bool are_samples_certain) {
  auto fitting = models_that_fit(seen);
  if (fitting.empty() && !are_samples_certain) {
    lidar_signs without = seen;
    without.sample_bytes = 0;
    fitting = models_that_fit(without);
  }
  if (!fitting.empty()) return fitting;
  seen.id = 0;
  fitting = models_that_fit(seen);
  return fitting.empty() ? models_of_size(seen) : fitting;
}

bool may_be_two_way(const lidar_signs& seen) {
  const std::vector<const model*> all = models_that_fit(seen);
  const auto is_near = [&seen](const model* row) { return may_measure(*row, seen); };
  if (std::ranges::any_of(all, is_near)) {
    return std::ranges::any_of(all,
                               [&](const model* row) { return is_near(row) && is_two_way(row); });
  }
  return std::ranges::any_of(all, is_two_way);
}

}  // namespace g4lidar
