// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_places.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/places.hpp"

namespace adit::engine {
namespace {

constexpr double kCell = 0.5;  // m
constexpr uint32_t kPosts = 40;
constexpr uint32_t kTurn = 10;                                    // sectors
constexpr std::pair<int, int> kShift = {3, -2};                   // cells
constexpr uint32_t kPole = 2U << 30U | 0x3fffU << 15U | 0x3fffU;  // a line along z

constexpr double kSector = 2.0 * std::numbers::pi / gpu::kPlaceSectors;

/// A post in the middle of a sector, a ring and a layer.
struct Post {
  uint32_t sector = 0;
  uint32_t ring = 0;
  uint32_t layer = 0;

  gpu::uvec4 point(uint32_t turn) const {
    const double angle = (sector + turn + 0.5) * kSector;
    const double range = std::exp2(1.0 + (ring + 0.5) / 6.0);
    const auto bits = [](double value) {
      return std::bit_cast<uint32_t>(static_cast<float>(value));
    };
    return {bits(range * std::cos(angle)), bits(range * std::sin(angle)),
            bits(layer == 0 ? -1.0 : 1.5), kPole};
  }
};

std::vector<Post> known_posts() {
  std::vector<Post> posts;
  for (uint32_t i = 0; i < kPosts; ++i) {
    posts.push_back({.sector = (7 * i * i + i) % gpu::kPlaceSectors,
                     .ring = (5 * i) % 29,
                     .layer = i % gpu::kPlaceLayers});
  }
  return posts;
}

std::vector<gpu::uvec4> points_of(const std::vector<Post>& posts, uint32_t turn) {
  std::vector<gpu::uvec4> points;
  for (const Post& post : posts) {
    points.push_back(post.point(turn));
  }
  return points;
}

template <class T>
Buffer uploaded(Context& context, const std::vector<T>& values) {
  Buffer buffer =
      context.make_buffer(values.size() * sizeof(T), Memory::upload, "self-test of places");
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

SelfTestCase check_description(const std::vector<Post>& posts, std::span<const uint32_t> record) {
  std::vector<uint32_t> expected(gpu::kPolarWords, 0);
  std::set<std::pair<int, int>> cells;
  for (const Post& post : posts) {
    expected[gpu::kPlaceLayers * post.sector + post.layer] |= 1U << post.ring;
    const gpu::uvec4 point = post.point(0);
    const int x = static_cast<int>(std::floor(std::bit_cast<float>(point.x) / kCell));
    const int y = static_cast<int>(std::floor(std::bit_cast<float>(point.y) / kCell));
    if (std::max(std::abs(x + 0.5), std::abs(y + 0.5)) < 0.5 * gpu::kPlanSide) {
      cells.insert({x, y});
    }
  }
  uint32_t wrong = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    wrong += expected[i] == record[i] ? 0U : 1U;
  }
  std::size_t found = 0;
  for (std::size_t i = gpu::kPlanAt; i < gpu::kPlanAt + gpu::kPlanWords; ++i) {
    found += static_cast<std::size_t>(std::popcount(record[i]));
  }
  return {"place_describe", wrong == 0 && found == cells.size(),
          "expected " + std::to_string(posts.size()) + " posts in " + std::to_string(cells.size()) +
              " cells of the plan, found " + std::to_string(found) + " cells and " +
              std::to_string(wrong) + " words of the polar view wrong"};
}

}  // namespace

std::vector<SelfTestCase> test_places(Context& context) {
  const PlaceKernels kernels(context);
  const std::vector<Post> posts = known_posts();
  const Buffer place = uploaded(context, points_of(posts, 0));
  const Buffer query = uploaded(context, points_of(posts, kTurn));
  // The centres of the first posts' cells, moved back by the shift: all have one.
  std::vector<gpu::vec2> centres;
  for (const Post& post : posts) {
    const gpu::uvec4 point = post.point(0);
    if (post.ring < 24) {
      centres.push_back({static_cast<float>(std::floor(std::bit_cast<float>(point.x) / kCell)) +
                             0.5F - static_cast<float>(kShift.first),
                         static_cast<float>(std::floor(std::bit_cast<float>(point.y) / kCell)) +
                             0.5F - static_cast<float>(kShift.second)});
    }
  }
  const auto cells = static_cast<uint32_t>(centres.size());
  const Buffer cells_buffer = uploaded(context, centres);
  const Buffer jobs = uploaded(
      context, std::vector{gpu::PlanJob{.cosine = 1.0F, .sine = 0.0F, .place = 0, .unused0 = 0}});
  const Buffer record =
      context.make_buffer(PlaceKernels::record_bytes(), Memory::device, "self-test's record");
  const Buffer second =
      context.make_buffer(PlaceKernels::record_bytes(), Memory::device, "self-test's query");
  const Buffer block =
      context.make_buffer(PlaceKernels::block_bytes(), Memory::device, "self-test's places");
  const Buffer matches = context.make_buffer(2 * kSliceAlignment, Memory::device, "matches");
  const Buffer record_back = context.make_buffer(record.size(), Memory::readback, "record back");
  const Buffer matches_back = context.make_buffer(matches.size(), Memory::readback, "matches back");
  Recorder recorder = context.make_recorder();
  const PlaceCloud cloud{.points = place, .count = kPosts, .cell = kCell};
  kernels.record_describe(recorder, cloud, record, block, 0);
  recorder.barrier();
  kernels.record_describe(recorder, {.points = query, .count = kPosts, .cell = kCell}, second,
                          block, 1);
  recorder.barrier();
  kernels.record_match(recorder, second, block, 1, matches.slice(0, kSliceAlignment));
  kernels.record_correlate(recorder, {.cells = cells_buffer,
                                      .cell_count = cells,
                                      .jobs = jobs,
                                      .job_count = 1,
                                      .block = block,
                                      .matches = matches.slice(kSliceAlignment, kSliceAlignment)});
  recorder.barrier();
  recorder.copy(record, record_back);
  recorder.copy(matches, matches_back);
  context.submit(std::move(recorder)).wait();

  const auto words = record_back.as<uint32_t>();
  uint32_t bits = 0;
  for (std::size_t i = 0; i < gpu::kPolarWords; ++i) {
    bits += static_cast<uint32_t>(std::popcount(words[i]));
  }
  const uint32_t matched = matches_back.as<uint32_t>()[0];
  const uint32_t correlated = matches_back.as<uint32_t>()[kSliceAlignment / sizeof(uint32_t)];
  const auto shift = static_cast<uint32_t>((kShift.first + static_cast<int>(gpu::kShiftReach)) +
                                           (kShift.second + static_cast<int>(gpu::kShiftReach)) *
                                               static_cast<int>(gpu::kShiftSide));
  return {check_description(posts, words),
          {"place_match", matched == 2 * bits * gpu::kPlaceSectors + kTurn,
           "expected " + std::to_string(2 * bits) + " hits at a turn of " + std::to_string(kTurn) +
               " sectors, found " + std::to_string(matched / gpu::kPlaceSectors) + " at " +
               std::to_string(matched % gpu::kPlaceSectors)},
          {"place_correlate", correlated == (2 * cells << gpu::kShiftBits | shift),
           "expected " + std::to_string(2 * cells) + " hits at shift " + std::to_string(shift) +
               ", found " + std::to_string(correlated >> gpu::kShiftBits) + " at " +
               std::to_string(correlated & ((1U << gpu::kShiftBits) - 1U))}};
}

}  // namespace adit::engine
