// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/place_index.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "adit/engine/context.hpp"

namespace adit {
namespace {

using engine::Buffer;
using engine::Memory;

constexpr double kSector = 2.0 * std::numbers::pi / gpu::kPlaceSectors;
// A polar view with fewer bits looks like too much else.
constexpr uint32_t kLeastBits = 40;
// The turn is known to half a sector; plans are correlated at so many quarters of one to both
// sides.
constexpr int kFineTurns = 3;

uint32_t bits_of(std::span<const uint32_t> words) {
  uint32_t bits = 0;
  for (const uint32_t word : words) {
    bits += static_cast<uint32_t>(std::popcount(word));
  }
  return bits;
}

/// Cells of a plan, evenly thinned to as many as are correlated: centres from the origin, in cells.
std::vector<gpu::vec2> centres_of(const PlaceDescriptor& descriptor) {
  constexpr float kHalf = 0.5F * gpu::kPlanSide - 0.5F;
  std::vector<gpu::vec2> centres;
  for (uint32_t i = 0; i < gpu::kPlanSide * gpu::kPlanSide; ++i) {
    if ((descriptor.plan[i / 32] >> (i % 32) & 1U) != 0) {
      centres.push_back({static_cast<float>(i % gpu::kPlanSide) - kHalf,
                         static_cast<float>(i / gpu::kPlanSide) - kHalf});
    }
  }
  const std::size_t step = (centres.size() + engine::kMostPlanCells - 1) / engine::kMostPlanCells;
  for (std::size_t i = 0; step > 1 && i * step < centres.size(); ++i) {
    centres[i] = centres[i * step];
  }
  centres.resize(step > 1 ? (centres.size() + step - 1) / step : centres.size());
  return centres;
}

template <class T>
Buffer staged(engine::Context& context, const std::vector<T>& values, std::string_view name) {
  Buffer buffer = context.make_buffer(values.size() * sizeof(T), Memory::upload, name);
  std::ranges::copy(values, buffer.as<T>().begin());
  return buffer;
}

PlaceGuess guess_of(std::size_t place, double yaw, uint32_t match, std::size_t cells,
                    double cell_edge) {
  const uint32_t shift = match & ((1U << gpu::kShiftBits) - 1U);
  const auto steps = [](uint32_t value) {
    return static_cast<double>(value) - static_cast<double>(gpu::kShiftReach);
  };
  PlaceGuess guess{
      .place = place,
      .likeness = 0.5 * static_cast<double>(match >> gpu::kShiftBits) / static_cast<double>(cells)};
  guess.T_place_newest.linear() =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  guess.T_place_newest.translation() =
      cell_edge *
      Eigen::Vector3d(steps(shift % gpu::kShiftSide), steps(shift / gpu::kShiftSide), 0.0);
  return guess;
}

}  // namespace

PlaceIndex::PlaceIndex(engine::Context& context)
    : context_(&context),
      kernels_(context),
      record_(context.make_buffer(engine::PlaceKernels::record_bytes(), Memory::device,
                                  "record of a place")) {}

// Room for one more.
std::size_t PlaceIndex::next() {
  if (sizes_.size() == blocks_.size() * gpu::kBlockPlaces) {
    blocks_.push_back(context_->make_buffer(engine::PlaceKernels::block_bytes(), Memory::device,
                                            "index of places"));
    engine::Recorder recorder = context_->make_recorder();
    recorder.fill(blocks_.back(), 0);
    context_->submit(std::move(recorder)).wait();
  }
  return sizes_.size();
}

PlaceDescriptor PlaceIndex::add(const SurfaceCloud& cloud, double cell) {
  const std::size_t place = next();
  const Buffer back = context_->make_buffer(record_.size(), Memory::readback, "record of a place");
  engine::Recorder recorder = context_->make_recorder();
  kernels_.record_describe(recorder, {.points = cloud.points, .count = cloud.size, .cell = cell},
                           record_, blocks_.back(),
                           static_cast<uint32_t>(place % gpu::kBlockPlaces));
  recorder.barrier();
  recorder.copy(record_, back);
  context_->submit(std::move(recorder)).wait();
  const auto words = back.as<uint32_t>();
  PlaceDescriptor descriptor{.cell = cell};
  std::ranges::copy(words.first(gpu::kPolarWords), descriptor.polar.begin());
  std::ranges::copy(words.subspan(gpu::kPlanAt, gpu::kPlanWords), descriptor.plan.begin());
  sizes_.push_back(bits_of(descriptor.polar));
  newest_ = descriptor;
  return descriptor;
}

void PlaceIndex::add_described(std::span<const std::optional<PlaceDescriptor>> places) {
  if (!sizes_.empty()) {
    throw std::logic_error("places that were described before come first");
  }
  for (std::size_t first = 0; first < places.size(); first += gpu::kBlockPlaces) {
    const std::size_t count = std::min<std::size_t>(places.size() - first, gpu::kBlockPlaces);
    std::vector<uint32_t> block(gpu::kBlockWords);
    for (std::size_t place = 0; place < count; ++place) {
      const std::optional<PlaceDescriptor>& described = places[first + place];
      sizes_.push_back(described ? bits_of(described->polar) : 0);
      if (described) {
        for (std::size_t word = 0; word < gpu::kPolarWords; ++word) {
          block[word * gpu::kBlockPlaces + place] = described->polar[word];
        }
        std::ranges::copy(described->plan,
                          block.begin() + static_cast<std::ptrdiff_t>(gpu::kBlockPlansAt +
                                                                      place * gpu::kPlanWords));
      }
    }
    blocks_.push_back(context_->make_buffer(engine::PlaceKernels::block_bytes(), Memory::device,
                                            "index of places"));
    const Buffer upload = staged(*context_, block, "index of places");
    engine::Recorder recorder = context_->make_recorder();
    recorder.copy(upload, blocks_.back());
    context_->submit(std::move(recorder)).wait();
  }
  newest_ = places.empty() ? std::nullopt : places.back();
}

void PlaceIndex::add_unknown() {
  static_cast<void>(next());
  sizes_.push_back(0);
  newest_.reset();
}

std::vector<SimilarPlace> PlaceIndex::similar() const {
  const std::size_t earlier = sizes_.empty() ? 0 : sizes_.size() - 1;
  if (earlier == 0 || !newest_ || sizes_.back() < kLeastBits) {
    return {};
  }
  const uint64_t block_matches = uint64_t{gpu::kBlockPlaces} * sizeof(uint32_t);
  const Buffer matches =
      context_->make_buffer(blocks_.size() * block_matches, Memory::device, "matches of places");
  const Buffer back = context_->make_buffer(matches.size(), Memory::readback, "matches of places");
  engine::Recorder recorder = context_->make_recorder();
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    const std::size_t first = i * gpu::kBlockPlaces;
    if (first < earlier) {
      const std::size_t count = std::min<std::size_t>(earlier - first, gpu::kBlockPlaces);
      kernels_.record_match(recorder, record_, blocks_[i], static_cast<uint32_t>(count),
                            matches.slice(i * block_matches, block_matches));
    }
  }
  recorder.barrier();
  recorder.copy(matches, back);
  context_->submit(std::move(recorder)).wait();
  const auto found = back.as<uint32_t>();
  std::vector<SimilarPlace> places;
  for (std::size_t i = 0; i < earlier; ++i) {
    if (sizes_[i] < kLeastBits) {
      continue;
    }
    const auto most = static_cast<double>(std::max(sizes_[i], sizes_.back()));
    places.push_back({.place = i,
                      .similarity = 0.5 * static_cast<double>(found[i] / gpu::kPlaceSectors) / most,
                      .yaw = -kSector * static_cast<double>(found[i] % gpu::kPlaceSectors)});
  }
  return places;
}

std::vector<PlaceGuess> PlaceIndex::guesses(std::span<const SimilarPlace> places) const {
  const std::vector<gpu::vec2> centres = newest_ ? centres_of(*newest_) : std::vector<gpu::vec2>();
  if (centres.empty() || places.empty()) {
    return {};
  }
  std::vector<gpu::PlanJob> jobs;
  std::vector<double> yaws;
  for (const SimilarPlace& similar : places) {
    for (int turn = -kFineTurns; turn <= kFineTurns; ++turn) {
      yaws.push_back(similar.yaw + 0.25 * kSector * turn);
      jobs.push_back({.cosine = static_cast<float>(std::cos(yaws.back())),
                      .sine = static_cast<float>(std::sin(yaws.back())),
                      .place = static_cast<uint32_t>(similar.place % gpu::kBlockPlaces),
                      .unused0 = 0});
    }
  }
  constexpr uint32_t kTurns = 2 * kFineTurns + 1;
  const Buffer cells = staged(*context_, centres, "cells of a plan");
  const Buffer jobs_buffer = staged(*context_, jobs, "plans to correlate");
  const Buffer matches =
      context_->make_buffer(jobs.size() * sizeof(uint32_t), Memory::readback, "matches of plans");
  engine::Recorder recorder = context_->make_recorder();
  const auto block_of = [](const SimilarPlace& one) { return one.place / gpu::kBlockPlaces; };
  for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
    for (end = i; end < places.size() && block_of(places[end]) == block_of(places[i]);) {
      ++end;
    }
    recorder.barrier();
    kernels_.record_correlate(recorder, {.cells = cells,
                                         .cell_count = static_cast<uint32_t>(centres.size()),
                                         .jobs = jobs_buffer,
                                         .first_job = static_cast<uint32_t>(i) * kTurns,
                                         .job_count = static_cast<uint32_t>(end - i) * kTurns,
                                         .block = blocks_[block_of(places[i])],
                                         .matches = matches});
  }
  context_->submit(std::move(recorder)).wait();
  const auto found = matches.as<uint32_t>();
  std::vector<PlaceGuess> guesses;
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::size_t best = i * kTurns;
    for (std::size_t job = best; job < (i + 1) * kTurns; ++job) {
      best = found[job] >> gpu::kShiftBits > found[best] >> gpu::kShiftBits ? job : best;
    }
    guesses.push_back(
        guess_of(places[i].place, yaws[best], found[best], centres.size(), newest_->cell));
  }
  return guesses;
}

}  // namespace adit
