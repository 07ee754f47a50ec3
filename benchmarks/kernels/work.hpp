// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is timed, and what it costs at least.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace adit::bench {

/// What a run has to do at least, whatever the device: inputs and outputs once each, and the
/// arithmetic of its definition. Counted by hand from the shaders (benchmarks/README.md tells how).
struct Cost {
  double bytes = 0.0;
  double flop = 0.0;     ///< additions, multiplications, divisions and roots of floats, 1 each
  double reads = 0.0;    ///< records of up to 64 bytes at random places
  double atomics = 0.0;  ///< integer additions at random places
  double dispatches = 0.0;
};

/// What the clocks say of one run, ms; none where a clock does not apply.
struct Sample {
  std::optional<double> device_ms;  ///< the device's own clock
  std::optional<double> wait_ms;    ///< from submitting to the end of the wait
  double host_ms = 0.0;             ///< all of it, recording included
};

/// Something made ready, verified, and able to run any number of times.
struct Work {
  std::string problem{};      ///< what its verification found wrong; empty: nothing
  std::string verified_by{};  ///< "double-precision twin: ...", or what else it was held to
  std::function<Sample()> run{};
  std::function<void()> undo{};  ///< after each run, not timed; may be empty
  uint64_t items = 0;            ///< per run: points, pairs
  Cost cost{};
  std::map<std::string, double> figures{};  ///< the result's: "error mm", "iterations"
};

enum class CaseKind {
  kernel,        ///< one family of kernels
  registration,  ///< an alignment, or all from raw points to a pose
  batch,         ///< alignments that share every dispatch; sizes are pairs
  peer,          ///< the same work by others, on the host
};
std::string to_string(CaseKind kind);

class Bench;

struct Case {
  std::string name{};
  CaseKind kind = CaseKind::kernel;
  std::string item = "point";
  std::string peer{};                       ///< the case that does the same work; empty: none
  int least = 0;                            ///< points; smaller sizes are left out
  int most = 1'000'000;                     ///< and larger ones
  std::function<Work(Bench&, int)> make{};  ///< makes a size
};

}  // namespace adit::bench
