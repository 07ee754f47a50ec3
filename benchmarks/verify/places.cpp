// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "adit/benchmarks/verify/transfer.hpp"

namespace adit::test {
namespace {

using engine::Memory;

constexpr std::size_t kMostProblems = 5;

void note(Verdict& verdict, const std::string& problem) {
  if (verdict.problems.size() < kMostProblems) {
    verdict.problems.push_back(problem);
  }
}

std::array<uint32_t, gpu::kPolarWords> polar_of(std::span<const uint32_t> block, uint32_t place) {
  std::array<uint32_t, gpu::kPolarWords> words{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = block[i * gpu::kBlockPlaces + place];
  }
  return words;
}

std::span<const uint32_t> plan_of(std::span<const uint32_t> block, uint32_t place) {
  return block.subspan(gpu::kBlockPlansAt + std::size_t{gpu::kPlanWords} * place, gpu::kPlanWords);
}

/// How many certain ones are missing and how many found ones are not possible.
template <class Set>
void compare(Verdict& verdict, const Set& certain, const Set& possible, const Set& found,
             const std::string& what) {
  const auto missing =
      std::ranges::count_if(certain, [&](const auto& one) { return !found.contains(one); });
  const auto wrong =
      std::ranges::count_if(found, [&](const auto& one) { return !possible.contains(one); });
  if (missing + wrong > 0) {
    note(verdict, what + ": " + std::to_string(missing) + " missing, " + std::to_string(wrong) +
                      " that should not be there");
  }
  verdict.worst[what + " compared"] += static_cast<double>(certain.size());
}

}  // namespace

PlaceRun::PlaceRun(engine::Context& context)
    : context_(&context),
      kernels_(context),
      record_(context.make_buffer(engine::PlaceKernels::record_bytes(), Memory::device, "record")),
      block_(context.make_buffer(engine::PlaceKernels::block_bytes(), Memory::device, "places")) {}

Times PlaceRun::describe(const DeviceCloud& cloud, double cell, uint32_t place) {
  places_ = std::max(places_, place + 1);
  return run_and_wait(*context_, [&](engine::Recorder& recorder) {
    kernels_.record_describe(recorder,
                             {.points = cloud.points(), .count = cloud.size(), .cell = cell},
                             record_, block_, place);
  });
}

void PlaceRun::describe(const std::vector<gpu::uvec4>& cloud, double cell) {
  describe(DeviceCloud(*context_, cloud), cell, places_);
}

std::vector<uint32_t> PlaceRun::record() const {
  return download<uint32_t>(*context_, record_);
}

std::vector<uint32_t> PlaceRun::block() const {
  return download<uint32_t>(*context_, block_);
}

Times PlaceRun::match(uint32_t count) {
  const engine::Buffer matches =
      context_->make_buffer(std::max(count, 1U) * sizeof(uint32_t), Memory::device, "matches");
  const Times times = run_and_wait(*context_, [&](engine::Recorder& recorder) {
    kernels_.record_match(recorder, record_, block_, count, matches);
  });
  matches_ = download<uint32_t>(*context_, matches.slice(0, count * sizeof(uint32_t)));
  return times;
}

Times PlaceRun::correlate(const std::vector<Eigen::Vector2d>& cells,
                          const std::vector<gpu::PlanJob>& jobs) {
  std::vector<gpu::vec2> centres;
  for (const Eigen::Vector2d& cell : cells) {
    centres.push_back({static_cast<float>(cell.x()), static_cast<float>(cell.y())});
  }
  const engine::Buffer centres_buffer = upload(*context_, centres, "cells");
  const engine::Buffer jobs_buffer = upload(*context_, jobs, "jobs");
  const engine::Buffer matches = context_->make_buffer(
      std::max<std::size_t>(jobs.size(), 1) * sizeof(uint32_t), Memory::device, "matches");
  const Times times = run_and_wait(*context_, [&](engine::Recorder& recorder) {
    kernels_.record_correlate(recorder, {.cells = centres_buffer,
                                         .cell_count = static_cast<uint32_t>(cells.size()),
                                         .jobs = jobs_buffer,
                                         .job_count = static_cast<uint32_t>(jobs.size()),
                                         .block = block_,
                                         .matches = matches});
  });
  matches_ = download<uint32_t>(*context_, matches.slice(0, jobs.size() * sizeof(uint32_t)));
  return times;
}

std::vector<Eigen::Vector2d> plan_centres(std::span<const uint32_t> record) {
  std::vector<Eigen::Vector2d> centres;
  const double half = 0.5 * gpu::kPlanSide - 0.5;
  for (const auto& [x, y] : reference::plan_cells(record.subspan(gpu::kPlanAt, gpu::kPlanWords))) {
    centres.emplace_back(x - half, y - half);
  }
  return centres;
}

Verdict verify_described(const reference::DescribedPlace& expected,
                         std::span<const uint32_t> record, std::span<const uint32_t> block,
                         uint32_t place) {
  Verdict verdict;
  const auto bits = reference::polar_bits(record);
  const auto plan = record.subspan(gpu::kPlanAt, gpu::kPlanWords);
  compare(verdict, expected.certain_bits, expected.possible_bits, bits, "bits of the polar view");
  compare(verdict, expected.certain_cells, expected.possible_cells, reference::plan_cells(plan),
          "cells of the plan");
  if (!std::ranges::equal(polar_of(block, place), record.first(gpu::kPolarWords)) ||
      !std::ranges::equal(plan_of(block, place), plan)) {
    note(verdict, "the block's place is not the record");
  }
  const auto spread = reference::polar_bits(record.subspan(gpu::kSpreadAt));
  for (int sector = 0; sector < static_cast<int>(gpu::kPlaceSectors); ++sector) {
    for (int layer = 0; layer < static_cast<int>(gpu::kPlaceLayers); ++layer) {
      for (int ring = 0; ring < 32; ++ring) {
        const reference::DescribedPlace::Bit bit = {sector, layer, ring};
        if (spread.contains(bit) != reference::is_beside(bits, bit, 0)) {
          note(verdict, "the spread view is wrong at sector " + std::to_string(sector) + ", ring " +
                            std::to_string(ring));
        }
      }
    }
  }
  return verdict;
}

Verdict verify_matches(std::span<const uint32_t> record, std::span<const uint32_t> block,
                       std::span<const uint32_t> matches) {
  Verdict verdict;
  const auto query = reference::polar_bits(record);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto place = reference::polar_bits(polar_of(block, static_cast<uint32_t>(i)));
    int most = 0;
    for (int turn = 0; turn < static_cast<int>(gpu::kPlaceSectors); ++turn) {
      most = std::max(most, reference::polar_hits(query, place, turn));
    }
    const auto hits = static_cast<int>(matches[i] / gpu::kPlaceSectors);
    const auto turn = static_cast<int>(matches[i] % gpu::kPlaceSectors);
    if (hits != most || reference::polar_hits(query, place, turn) != most) {
      note(verdict, "place " + std::to_string(i) + ": expected " + std::to_string(most) +
                        " hits, found " + std::to_string(hits) + " at turn " +
                        std::to_string(turn));
    }
    verdict.worst["places compared"] += 1.0;
  }
  return verdict;
}

Verdict verify_correlations(std::span<const Eigen::Vector2d> cells,
                            std::span<const gpu::PlanJob> jobs, std::span<const uint32_t> block,
                            std::span<const uint32_t> matches) {
  Verdict verdict;
  const int reach = static_cast<int>(gpu::kShiftReach);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const auto plan = reference::plan_cells(plan_of(block, jobs[i].place));
    const double angle = std::atan2(jobs[i].sine, jobs[i].cosine);
    const auto found = static_cast<int>(matches[i] >> gpu::kShiftBits);
    const auto shift = static_cast<int>(matches[i] & ((1U << gpu::kShiftBits) - 1U));
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const reference::PlanHits twin = reference::plan_hits(cells, plan, angle, x, y);
        const bool chosen = shift == (x + reach) + (y + reach) * static_cast<int>(gpu::kShiftSide);
        const int fewest = twin.hits - twin.uncertain;
        if (found < fewest || (chosen && found > twin.hits)) {
          note(verdict, "job " + std::to_string(i) + " at (" + std::to_string(x) + ", " +
                            std::to_string(y) + "): expected " + std::to_string(fewest) + " to " +
                            std::to_string(twin.hits) + " hits, found " + std::to_string(found));
        }
      }
    }
    verdict.worst["jobs compared"] += 1.0;
  }
  return verdict;
}

}  // namespace adit::test
