// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/host_vgicp.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "adit/benchmarks/reference/vgicp.hpp"

namespace adit::bench {
namespace {

constexpr size_t kBlock = 256;  // points between additions to the double sums
constexpr auto kEpsilon = static_cast<float>(reference::kPlaneEpsilon);

uint64_t key_of(int x, int y, int z) {
  const auto bits = [](int v) { return static_cast<uint64_t>(v + (1 << 20)) & 0x1fffffU; };
  return ((bits(x) << 42U) | (bits(y) << 21U) | bits(z)) + 1U;
}

uint64_t mixed(uint64_t h) {
  h = (h ^ (h >> 33U)) * 0xff51afd7ed558ccdU;
  return h ^ (h >> 33U);
}

std::array<float, 6> triangle(const Eigen::Matrix3d& m) {
  const Eigen::Matrix3f f = m.cast<float>();
  return {f(0, 0), f(0, 1), f(0, 2), f(1, 1), f(1, 2), f(2, 2)};
}

Eigen::Matrix3f full(const float* t) {
  Eigen::Matrix3f m;
  m << t[0], t[1], t[2], t[1], t[3], t[4], t[2], t[4], t[5];
  return m;
}

}  // namespace

HostVgicp::HostVgicp(const std::vector<reference::SurfacePoint>& source,
                     const reference::VoxelMap& target, double d_max, unsigned threads)
    : inverse_cell_(static_cast<float>(1.0 / target.voxel_size)),
      max_squared_(static_cast<float>(d_max * d_max)),
      parts_(std::max(threads, 1U)),
      begin_(static_cast<std::ptrdiff_t>(parts_.size())),
      end_(static_cast<std::ptrdiff_t>(parts_.size())) {
  for (const reference::SurfacePoint& point : source) {
    SourcePoint& made = source_.emplace_back();
    std::ranges::copy(std::array{static_cast<float>(point.p.x()), static_cast<float>(point.p.y()),
                                 static_cast<float>(point.p.z())},
                      made.p);
    std::ranges::copy(triangle(point.constraint()), made.constraint);
  }
  mask_ = std::bit_ceil(std::max<uint64_t>(2 * target.voxels.size(), 16)) - 1;
  table_.resize(mask_ + 1);
  for (const auto& [at, voxel] : target.voxels) {
    const uint64_t key =
        key_of(static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]));
    uint64_t slot = mixed(key) & mask_;
    while (table_[slot].key != 0) {
      slot = (slot + 1) & mask_;
    }
    const Eigen::Vector3f mean = voxel.mean(at, target.voxel_size).cast<float>();
    table_[slot].key = key;
    std::ranges::copy(std::array{mean.x(), mean.y(), mean.z()}, table_[slot].mean);
    std::ranges::copy(triangle(voxel.constraint()), table_[slot].constraint);
  }
  for (size_t part = 1; part < parts_.size(); ++part) {
    workers_.emplace_back([this, part] { work(part); });
  }
}

HostVgicp::~HostVgicp() {
  done_ = true;
  if (!workers_.empty()) {
    begin_.arrive_and_wait();
  }
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

void HostVgicp::work(size_t part) {
  while (true) {
    begin_.arrive_and_wait();
    if (done_) {
      return;
    }
    add(part);
    end_.arrive_and_wait();
  }
}

HostVgicp::Sums HostVgicp::linearize(const Eigen::Isometry3d& pose) {
  pose_ = pose.cast<float>();
  begin_.arrive_and_wait();
  add(0);
  end_.arrive_and_wait();
  Sums sums{};
  for (const Sums& part : parts_) {
    for (size_t k = 0; k < sums.size(); ++k) {
      sums[k] += part[k];
    }
  }
  return sums;
}

// The points of one thread. H and g of a match are those of benchmarks/reference/vgicp.hpp.
void HostVgicp::add(size_t part) {
  Sums& total = parts_[part];
  total = {};
  const Eigen::Matrix3f rotation = pose_.linear();
  const Eigen::Vector3f t = pose_.translation();
  const size_t begin = source_.size() * part / parts_.size();
  const size_t end = source_.size() * (part + 1) / parts_.size();
  for (size_t block = begin; block < end; block += kBlock) {
    std::array<float, 29> sums{};
    for (size_t i = block; i < std::min(end, block + kBlock); ++i) {
      const SourcePoint& point = source_[i];
      const Eigen::Vector3f ra = rotation * Eigen::Vector3f(point.p[0], point.p[1], point.p[2]);
      const Eigen::Vector3f q = ra + t;
      const Eigen::Vector3f corner = (q * inverse_cell_).array().floor();
      const uint64_t key = key_of(static_cast<int>(corner.x()), static_cast<int>(corner.y()),
                                  static_cast<int>(corner.z()));
      uint64_t slot = mixed(key) & mask_;
      while (table_[slot].key != key && table_[slot].key != 0) {
        slot = (slot + 1) & mask_;
      }
      const Voxel& voxel = table_[slot];
      const Eigen::Vector3f e = Eigen::Vector3f(voxel.mean[0], voxel.mean[1], voxel.mean[2]) - q;
      if (voxel.key == 0 || e.squaredNorm() > max_squared_) {
        continue;
      }
      const Eigen::Matrix3f omega =
          (2.0F * Eigen::Matrix3f::Identity() -
           (1.0F - kEpsilon) *
               (full(voxel.constraint) + rotation * full(point.constraint) * rotation.transpose()))
              .inverse();
      const Eigen::Vector3f oe = omega * e;
      Eigen::Matrix3f turn;
      turn << 0.0F, -ra.z(), ra.y(), ra.z(), 0.0F, -ra.x(), -ra.y(), ra.x(), 0.0F;
      const Eigen::Matrix3f tr = -omega * turn;
      const Eigen::Matrix3f rr = turn * tr;
      const Eigen::Vector3f gr = ra.cross(oe);
      const std::array<float, 29> terms = {
          omega(0, 0), omega(0, 1), omega(0, 2), tr(0, 0),  tr(0, 1), tr(0, 2),
          omega(1, 1), omega(1, 2), tr(1, 0),    tr(1, 1),  tr(1, 2), omega(2, 2),
          tr(2, 0),    tr(2, 1),    tr(2, 2),    rr(0, 0),  rr(0, 1), rr(0, 2),
          rr(1, 1),    rr(1, 2),    rr(2, 2),    -oe.x(),   -oe.y(),  -oe.z(),
          -gr.x(),     -gr.y(),     -gr.z(),     e.dot(oe), 1.0F};
      for (size_t k = 0; k < sums.size(); ++k) {
        sums[k] += terms[k];
      }
    }
    for (size_t k = 0; k < sums.size(); ++k) {
      total[k] += static_cast<double>(sums[k]);
    }
  }
}

}  // namespace adit::bench
