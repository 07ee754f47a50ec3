// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>

#include <fmt/core.h>

#include "adit/benchmarks/kernels/report.hpp"
#include "adit/slam/core/text.hpp"

namespace adit::bench {
namespace {

// Three significant digits.
std::string three_digits(double value) {
  const double size = std::abs(value);
  return with_decimals(value, size < 0.995 ? 3 : (size < 9.95 ? 2 : (size < 99.5 ? 1 : 0)));
}

std::string clock(const std::optional<Spread>& spread) {
  return spread ? three_digits(spread->median) : "-";
}

}  // namespace

void print_setting(const Report& report, std::ostream& out) {
  const Setting& s = report.setting;
  const DeviceLimits& l = report.limits;
  out << "device   " << s.device << ", " << s.driver << " " << s.driver_version << ", Vulkan "
      << s.vulkan << (s.software ? ", software" : "") << "\n"
      << "host     " << s.host << ", " << s.threads << " threads\n"
      << "adit     " << s.version << " (" << s.commit << "); peers: " << s.peers << "\n"
      << "clouds   " << s.input << "\n"
      << "limits   copy " << three_digits(1e-9 * l.copy_bytes) << " GB/s; multiply-add "
      << three_digits(1e-9 * l.flop) << " GFLOP/s; 64-byte reads at random "
      << three_digits(1e-6 * l.near_reads) << " M/s of 1 MiB, " << three_digits(1e-6 * l.reads)
      << " M/s of 64 MiB; atomics " << three_digits(1e-6 * l.atomics) << " M/s; dispatch "
      << three_digits(1e6 * l.dispatch_s) << " us; submission "
      << three_digits(1e6 * l.submission_s) << " us\n\n";
}

void print_head(std::ostream& out) {
  out << std::left << std::setw(22) << "case" << std::right << std::setw(9) << "size"
      << std::setw(9) << "items" << std::setw(11) << "device ms" << std::setw(9) << "wait ms"
      << std::setw(9) << "host ms" << std::setw(11) << "ns an item" << std::setw(8) << "GB/s"
      << std::setw(9) << "GFLOP/s" << std::setw(20) << "of its limit" << std::setw(9) << "x peer"
      << "  result\n";
}

void print_row(const Row& row, const Report& report, std::ostream& out) {
  out << std::left << std::setw(22) << row.name << std::right << std::setw(9) << row.size
      << std::setw(9) << row.items;
  if (!row.problem.empty()) {
    out << "  WRONG, not timed: " << row.problem << "\n";
    return;
  }
  const double ms = row.timing.best().median;
  const Bound bound = bound_of(row.cost, report.limits);
  const bool counted = bound.ms > 0.0;
  const Row* peer = peer_of(row, report);
  const std::string share =
      counted ? fmt::format("{} % {}", three_digits(100.0 * bound.ms / ms), bound.by) : "-";
  out << std::setw(11) << clock(row.timing.device) << std::setw(9) << clock(row.timing.wait)
      << std::setw(9) << three_digits(row.timing.host.median) << std::setw(11)
      << three_digits(row.ns_an_item()) << std::setw(8)
      << (counted ? three_digits(1e-6 * row.cost.bytes / ms) : "-") << std::setw(9)
      << (counted ? three_digits(1e-6 * row.cost.flop / ms) : "-") << std::setw(20) << share
      << std::setw(9)
      << (peer != nullptr && peer->problem.empty() ? three_digits(ms / peer->timing.best().median)
                                                   : "-")
      << " ";
  const char* separator = " ";
  for (const auto& [name, value] : row.figures) {
    out << separator << name << " "
        << (value == std::floor(value) ? std::to_string(std::lround(value)) : three_digits(value));
    separator = ", ";
  }
  out << "\n";
}

void print_limits(const Report& report, std::ostream& out) {
  const LimitsMoved& moved = report.limits_moved;
  out << fmt::format("\nlimits   measured again at the end; {} moved most, by {:.0f} %\n",
                     moved.which, 100.0 * (moved.ratio - 1.0));
  if (!limits_hold(report)) {
    out << "note: the machine was disturbed: shares of limits are void, and times too long\n";
  }
}

void print_comparison(const Report& before, const Report& after, std::ostream& out) {
  out << "before   " << before.setting.device << ", " << before.setting.version << " ("
      << before.setting.commit << "), " << before.setting.date << "\n"
      << "after    " << after.setting.device << ", " << after.setting.version << " ("
      << after.setting.commit << "), " << after.setting.date << "\n";
  if (before.setting.device != after.setting.device || before.setting.host != after.setting.host) {
    out << "note: not the same device and host\n";
  }
  const bool comparable = limits_hold(before) && limits_hold(after);
  if (!comparable) {
    out << "note: a machine was disturbed (its limits moved by more than 25 %): nothing is called "
           "faster or slower\n";
  }
  out << "\n"
      << std::left << std::setw(22) << "case" << std::right << std::setw(9) << "size"
      << std::setw(11) << "before ms" << std::setw(11) << "after ms" << std::setw(9) << "ratio"
      << std::setw(11) << "by limits"
      << "\n";
  for (const Row& row : after.rows) {
    const auto old = std::ranges::find_if(before.rows, [&](const Row& other) {
      return other.name == row.name && other.size == row.size;
    });
    if (old == before.rows.end() || !row.problem.empty() || !old->problem.empty()) {
      continue;
    }
    const Spread& a = old->timing.best();
    const Spread& b = row.timing.best();
    // What the limits let the machine do after, over before: above 1 it was slower as a whole.
    const double then = bound_of(row.cost, before.limits).ms;
    const double now = bound_of(row.cost, after.limits).ms;
    const double machine = then > 0.0 && now > 0.0 ? now / then : 1.0;
    const char* verdict = !comparable                ? ""
                          : b.high < machine * a.low ? "  faster"
                          : b.low > machine * a.high ? "  slower"
                                                     : "";
    out << std::left << std::setw(22) << row.name << std::right << std::setw(9) << row.size
        << std::setw(11) << three_digits(a.median) << std::setw(11) << three_digits(b.median)
        << std::setw(9) << three_digits(b.median / a.median) << std::setw(11)
        << three_digits(b.median / a.median / machine) << verdict << "\n";
  }
  out << "\nby limits: the ratio over that of the machine's limits each time; faster, slower: the "
         "10th "
         "to 90th\npercentiles, taken so, do not overlap\n";
}

}  // namespace adit::bench
