// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// A plane in square cells, of which only blocks that were touched take memory. Borders of cells
/// are at multiples of their size.
template <class Cell>
class CellGrid {
 public:
  using Index = Eigen::Matrix<int64_t, 2, 1>;

  /// `size`: m, of a cell.
  explicit CellGrid(double size) : size_(size) {}

  double size() const { return size_; }
  bool empty() const { return blocks_.empty(); }
  int64_t columns() const { return empty() ? 0 : high_.x() - low_.x() + 1; }
  int64_t rows() const { return empty() ? 0 : high_.y() - low_.y() + 1; }
  /// The lowest and the highest that were touched, along each axis.
  const Index& low() const { return low_; }
  const Index& high() const { return high_; }

  Index index_of(const Eigen::Vector2d& place) const {
    return {static_cast<int64_t>(std::floor(place.x() / size_)),
            static_cast<int64_t>(std::floor(place.y() / size_))};
  }

  Cell& touch(const Index& index) {
    if (empty()) {
      low_ = index;
      high_ = index;
    }
    low_ = low_.cwiseMin(index);
    high_ = high_.cwiseMax(index);
    std::vector<Cell>& block = blocks_[block_of(index)];
    if (block.empty()) {
      block.resize(static_cast<std::size_t>(kBlock * kBlock));
    }
    return block[within(index)];
  }

  /// As made, where its block was never touched.
  Cell at(const Index& index) const {
    const auto block = blocks_.find(block_of(index));
    return block == blocks_.end() ? Cell{} : block->second[within(index)];
  }

  /// Calls act(cell) for each cell of touched blocks.
  void for_each(const auto& act) const {
    for (const auto& [number, block] : blocks_) {
      for (const Cell& cell : block) {
        act(cell);
      }
    }
  }

 private:
  static constexpr int64_t kBlock = 256;  // cells along a side

  static int64_t block_of(int64_t cell) {
    return cell / kBlock - static_cast<int64_t>(cell % kBlock < 0);
  }
  static std::pair<int64_t, int64_t> block_of(const Index& index) {
    return {block_of(index.y()), block_of(index.x())};
  }
  static std::size_t within(const Index& index) {
    return static_cast<std::size_t>((index.y() - kBlock * block_of(index.y())) * kBlock +
                                    index.x() - kBlock * block_of(index.x()));
  }

  double size_;
  std::map<std::pair<int64_t, int64_t>, std::vector<Cell>> blocks_;
  Index low_ = Index::Zero();
  Index high_ = Index::Zero();
};

}  // namespace adit
