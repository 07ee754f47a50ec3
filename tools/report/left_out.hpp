// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// Where the clock of the sweeps was set back.
struct SweepClockStep {
  std::size_t sweep = 0;  ///< the first after it, in the recording
  double back = 0.0;      ///< s, from the last sweep before it
};

/// What of a recording a run left out or took in another order, counted, with the first reasons.
class LeftOut {
 public:
  /// A damaged place; a DeclarationError counts as what the recording declares and does not hold,
  /// on `sweep_topic` as sweeps. Each add_ returns the reason as a note for people, or nothing once
  /// enough of its kind were noted.
  std::optional<std::string> add_damage(const InputError& error, const std::string& sweep_topic);

  /// A sweep whose stamp is not after `last`, that of the sweep before it: it would have no place
  /// in a trajectory.
  std::optional<std::string> add_sweep(std::size_t index, const Sweep& sweep, Nanoseconds last);

  /// A sweep that was read after one with a later stamp and still found its place: the sweep number
  /// `index` of the trajectory.
  std::optional<std::string> add_put_in_order(std::size_t index);

  /// Something whole was read.
  void note_read() { ends_damaged_ = false; }
  /// Nothing whole was read after the last damaged place: a file that was cut off.
  bool ends_damaged() const { return ends_damaged_; }

  std::size_t damaged() const { return damage_.count; }     ///< places
  std::size_t not_rising() const { return stamps_.count; }  ///< sweeps
  /// Sweeps that the recording declares and does not hold, as far as it tells how many.
  uint64_t missing_sweeps() const { return missing_sweeps_; }
  /// The recording declares a file that is not there.
  bool lacks_files() const { return lacks_files_; }
  /// The recording declares sweeps, or a file, that it does not hold.
  bool lacks_sweeps() const { return missing_sweeps_ > 0 || lacks_files_; }
  std::size_t put_in_order() const { return order_.count; }  ///< sweeps; they are not left out
  /// Sweeps of the recording that were left out or are missing from it, of whatever kind.
  std::size_t sweeps() const { return stamps_.count + missing_sweeps_; }
  /// The first of them, in their order.
  const std::vector<SweepClockStep>& clock_steps() const { return clock_steps_; }
  bool any() const { return damaged() + not_rising() + contradictions_.count > 0; }
  /// The first damage; empty where there is none.
  std::string first_damage() const;

  /// The "left_out" of summary.json.
  nlohmann::ordered_json to_json() const;
  /// One line for people, without its end; empty where nothing was left out.
  std::string text() const;
  /// Where the clock was set back and what to do about it; empty where it was not.
  std::string clock_text() const;
  /// Likewise of the sweeps that were put in order.
  std::string order_text() const;

 private:
  struct Kind {
    std::size_t count = 0;
    std::vector<std::string> first{};
  };
  static std::optional<std::string> add(Kind& kind, const std::string& reason);

  Kind damage_;
  Kind contradictions_;
  uint64_t missing_sweeps_ = 0;
  uint64_t missing_messages_ = 0;  // with the sweeps
  bool lacks_files_ = false;
  bool ends_damaged_ = false;
  Kind stamps_;
  Kind order_;
  std::vector<SweepClockStep> clock_steps_;
  struct Stamped {
    std::size_t index = 0;
    Nanoseconds stamp{0};
  };
  Stamped after_step_;  ///< the last sweep that was left out since the clock was set back
};

}  // namespace adit
