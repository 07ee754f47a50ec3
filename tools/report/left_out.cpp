// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/left_out.hpp"

#include <chrono>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/containers/declaration_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kNoted = 5;  // per kind
constexpr std::size_t kKept = 10;  // for the summary
// Sweeps that come late are not as late as that, s.
constexpr double kClockSetBack = 1.0;

std::string counted(uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

std::optional<std::string> LeftOut::add(Kind& kind, const std::string& reason) {
  ++kind.count;
  if (kind.count <= kKept) {
    kind.first.push_back(reason);
  }
  if (kind.count > kNoted) {
    return std::nullopt;
  }
  return kind.count < kNoted ? reason : reason + " (further ones like it are only counted)";
}

std::optional<std::string> LeftOut::add_damage(const InputError& error,
                                               const std::string& sweep_topic) {
  if (const auto* declared = dynamic_cast<const DeclarationError*>(&error)) {
    const uint64_t missing = declared->missing().value_or(0);
    missing_messages_ += missing;
    missing_sweeps_ += declared->topic() == sweep_topic ? missing : 0;
    lacks_files_ = lacks_files_ || !declared->missing();
    return add(contradictions_, error.what());
  }
  ends_damaged_ = true;
  const std::optional<std::string> reason = add(damage_, error.what());
  return reason ? std::optional("left out: " + *reason) : std::nullopt;
}

std::optional<std::string> LeftOut::add_sweep(std::size_t index, const Sweep& sweep,
                                              Nanoseconds last) {
  const double back = seconds(last - sweep.stamp);
  if (back > kClockSetBack) {
    const bool goes_on = !clock_steps_.empty() && after_step_.index + 1 == index &&
                         seconds(after_step_.stamp - sweep.stamp) < kClockSetBack;
    after_step_ = {.index = index, .stamp = sweep.stamp};
    if (!goes_on && clock_steps_.size() < kKept) {
      clock_steps_.push_back({.sweep = index, .back = back});
    }
  }
  const std::string how =
      back > 0.0 ? fmt::format("{:.6f} s before that", back) : std::string("that");
  return add(stamps_, "sweep " + std::to_string(index) + " is left out: its time is " + how +
                          " of a sweep that was taken before it");
}

std::optional<std::string> LeftOut::add_put_in_order(std::size_t index) {
  return add(order_, "sweep " + std::to_string(index) +
                         " came after one with a later time: both are taken in the order of their "
                         "times");
}

std::string LeftOut::first_damage() const {
  return damage_.first.empty() ? std::string() : damage_.first.front();
}

nlohmann::ordered_json LeftOut::to_json() const {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  for (const SweepClockStep& step : clock_steps_) {
    steps.push_back({{"sweep", step.sweep}, {"back_s", step.back}});
  }
  return {{"damaged_places", damage_.count},
          {"sweeps_missing", missing_sweeps_},
          {"messages_missing", missing_messages_},
          {"sweeps_not_rising", stamps_.count},
          {"sweeps_put_in_order", order_.count},
          {"clock_set_back", std::move(steps)},
          {"damage", damage_.first},
          {"declarations", contradictions_.first},
          {"stamps", stamps_.first}};
}

std::string LeftOut::text() const {
  std::string text;
  if (missing_sweeps_ > 0) {
    text = counted(missing_sweeps_, "sweep that the recording declares is not in it",
                   "sweeps that the recording declares are not in it");
  } else if (contradictions_.count > 0) {
    text = "the recording does not hold what it declares";
  }
  if (damaged() > 0) {
    text += std::string(text.empty() ? "" : "; ") +
            counted(damaged(), "damaged place", "damaged places") +
            " in the recording (`adit inspect` lists them, --strict-input ends at the first)";
  }
  if (not_rising() > 0) {
    text += std::string(text.empty() ? "" : "; ") +
            counted(not_rising(), "sweep whose time is", "sweeps whose time is") +
            " not after that of the sweep before";
    text += clock_steps_.empty() ? "" : "; " + clock_text();
  }
  return text;
}

std::string LeftOut::clock_text() const {
  std::string text;
  for (const SweepClockStep& step : clock_steps_) {
    text += (text.empty() ? "the recording's clock was set back by " : " and by ") +
            fmt::format("{:.1f} s at sweep {}", step.back, step.sweep);
  }
  return text.empty() ? text
                      : text + fmt::format(
                                   "; sweeps after that were left out, `--start {}` maps "
                                   "them in a run of their own",
                                   clock_steps_.front().sweep);
}

std::string LeftOut::order_text() const {
  return put_in_order() == 0
             ? ""
             : counted(put_in_order(), "sweep that came", "sweeps that came") +
                   " after one with a later time, taken in the order of their times";
}

}  // namespace adit
