// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/copc_octree.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace adit {
namespace {

constexpr std::size_t kBlockPoints = 32'768;   // read at a time
constexpr std::size_t kPartBuffer = 64 << 10;  // bytes that wait for their part
// Parts are found by counting points in cells of so many levels below, 1024 a side: their number is
// bounded by the ground that a survey covers.
constexpr int32_t kCountedLevels = 10;
constexpr int32_t kDeepestLevel = 20;  // places times cells a side stay below 2^64
constexpr std::size_t kNodesAtATime =
    16;  // taken together, so that they are packed on all processors

uint64_t packed_key(const VoxelKey& key) {
  return (static_cast<uint64_t>(key.x) << 42) | (static_cast<uint64_t>(key.y) << 21) |
         static_cast<uint64_t>(key.z);
}

VoxelKey ancestor(const VoxelKey& key, int32_t level) {
  const int32_t up = key.level - level;
  return {level, key.x >> up, key.y >> up, key.z >> up};
}

VoxelKey child(const VoxelKey& key, std::size_t octant) {
  const auto bit = [&](std::size_t axis) { return static_cast<int32_t>((octant >> axis) & 1U); };
  return {key.level + 1, 2 * key.x + bit(0), 2 * key.y + bit(1), 2 * key.z + bit(2)};
}

std::size_t octant_of(const VoxelKey& key, int32_t level) {
  const VoxelKey at = ancestor(key, level);
  return static_cast<std::size_t>((at.x & 1) | ((at.y & 1) << 1) | ((at.z & 1) << 2));
}

/// A subtree, and which points of a file are its own.
struct Part {
  VoxelKey root{};
  uint64_t begin = 0;  ///< first point
  uint64_t points = 0;
};

/// Calls take(point) with the bytes of each of a part's points, in order.
template <class Take>
void visit_points(const CopcPoints& points, const Part& part, const Take& take) {
  std::string block;
  const std::size_t size = points.point_bytes;
  const uint64_t end = (part.begin + part.points) * size;
  for (uint64_t begin = part.begin * size; begin < end; begin += block.size()) {
    block.resize(std::min(kBlockPoints * size, end - begin));
    points.file->read_at(begin, block);
    for (std::size_t at = 0; at < block.size(); at += size) {
      take(std::string_view(block).substr(at, size));
    }
  }
}

struct CountedCell {
  VoxelKey key{};
  uint64_t points = 0;
};

/// The parts below a node, and which of them each counted cell is in.
struct Parts {
  int32_t counted_level = 0;
  std::vector<Part> parts{};
  std::unordered_map<uint64_t, std::size_t> part_of{};
};

void split(const VoxelKey& root, std::vector<CountedCell> cells, uint64_t most, Parts& into) {
  const uint64_t points =
      std::accumulate(cells.begin(), cells.end(), uint64_t{0},
                      [](uint64_t sum, const CountedCell& cell) { return sum + cell.points; });
  if (points <= most || root.level == into.counted_level) {
    const uint64_t begin =
        into.parts.empty() ? 0 : into.parts.back().begin + into.parts.back().points;
    for (const CountedCell& cell : cells) {
      into.part_of.emplace(packed_key(cell.key), into.parts.size());
    }
    into.parts.push_back({.root = root, .begin = begin, .points = points});
    return;
  }
  std::array<std::vector<CountedCell>, 8> children;
  for (const CountedCell& cell : cells) {
    children[octant_of(cell.key, root.level + 1)].push_back(cell);
  }
  cells = {};
  for (std::size_t octant = 0; octant < children.size(); ++octant) {
    if (!children[octant].empty()) {
      split(child(root, octant), std::move(children[octant]), most, into);
    }
  }
}

Parts parts_of(const CopcPoints& points, const Part& whole, const CopcCube& cube, uint64_t most) {
  Parts parts{.counted_level = std::min(whole.root.level + kCountedLevels, kDeepestLevel)};
  std::map<VoxelKey, uint64_t> counts;
  visit_points(points, whole, [&](std::string_view point) {
    ++counts[cube.key_of(cube.place_of(point.data()), parts.counted_level)];
  });
  std::vector<CountedCell> cells;
  for (const auto& [key, count] : counts) {
    cells.push_back({.key = key, .points = count});
  }
  split(whole.root, std::move(cells), most, parts);
  return parts;
}

/// Writes the points in the order of their parts.
void sort_by_part(const CopcPoints& points, const Part& whole, const CopcCube& cube,
                  const Parts& parts, ScratchFile& sorted) {
  struct Open {
    uint64_t at = 0;
    std::string waiting{};
  };
  std::vector<Open> open;
  for (const Part& part : parts.parts) {
    open.push_back({.at = part.begin * points.point_bytes});
  }
  const auto write = [&](Open& part) {
    sorted.write_at(part.at, part.waiting);
    part.at += part.waiting.size();
    part.waiting.clear();
  };
  visit_points(points, whole, [&](std::string_view point) {
    const VoxelKey key = cube.key_of(cube.place_of(point.data()), parts.counted_level);
    Open& part = open[parts.part_of.at(packed_key(key))];
    part.waiting += point;
    if (part.waiting.size() >= kPartBuffer) {
      write(part);
    }
  });
  std::ranges::for_each(open, write);
}

/// Makes the nodes of one part after the other.
class OctreeMaker {
 public:
  OctreeMaker(const CopcCube& cube, const CopcLimits& limits, std::size_t point_bytes,
              const TakeNodes& take)
      : cube_(&cube), limits_(limits), point_bytes_(point_bytes), take_(&take) {}

  void add(const Part& part, const std::string& points);
  /// The nodes above all parts, which are known only now.
  void finish();

 private:
  struct CoarseNode {
    std::unordered_set<uint32_t> cells{};
    std::string points{};
  };
  using Indices = std::vector<uint32_t>;

  std::string_view point_at(const std::string& points, std::size_t index) const {
    return std::string_view(points).substr(index * point_bytes_, point_bytes_);
  }
  /// Whether a node above the part has taken a point.
  bool is_taken_above(const Part& part, const CopcCube::Place& place, std::string_view point);
  void build(const VoxelKey& key, Indices indices, const std::string& points);
  void emit(CopcNode node);
  void flush();

  const CopcCube* cube_;
  CopcLimits limits_;
  std::size_t point_bytes_;
  const TakeNodes* take_;
  std::map<VoxelKey, CoarseNode> coarse_{};
  std::vector<CopcNode> nodes_{};
  std::vector<bool> occupied_ = std::vector<bool>(kCopcCells * kCopcCells * kCopcCells);
};

void OctreeMaker::add(const Part& part, const std::string& points) {
  Indices indices;
  for (std::size_t i = 0; i < points.size() / point_bytes_; ++i) {
    const std::string_view point = point_at(points, i);
    if (!is_taken_above(part, cube_->place_of(point.data()), point)) {
      indices.push_back(static_cast<uint32_t>(i));
    }
  }
  if (!indices.empty()) {
    build(part.root, std::move(indices), points);
  }
}

bool OctreeMaker::is_taken_above(const Part& part, const CopcCube::Place& place,
                                 std::string_view point) {
  for (int32_t level = 0; level < part.root.level; ++level) {
    CoarseNode& node = coarse_[ancestor(part.root, level)];
    if (node.cells.insert(cube_->cell_of(place, level)).second) {
      node.points += point;
      return true;
    }
  }
  return false;
}

void OctreeMaker::build(const VoxelKey& key, Indices indices, const std::string& points) {
  CopcNode node{.key = key};
  if (indices.size() <= limits_.node || key.level == kDeepestLevel) {
    for (const uint32_t index : indices) {
      node.points += point_at(points, index);
    }
    emit(std::move(node));
    return;
  }
  std::array<Indices, 8> children;
  std::vector<uint32_t> cells;
  for (const uint32_t index : indices) {
    const std::string_view point = point_at(points, index);
    const CopcCube::Place place = cube_->place_of(point.data());
    const uint32_t cell = cube_->cell_of(place, key.level);
    if (!occupied_[cell]) {
      occupied_[cell] = true;
      cells.push_back(cell);
      node.points += point;
    } else {
      children[octant_of(cube_->key_of(place, key.level + 1), key.level + 1)].push_back(index);
    }
  }
  for (const uint32_t cell : cells) {
    occupied_[cell] = false;
  }
  indices = {};
  emit(std::move(node));
  for (std::size_t octant = 0; octant < children.size(); ++octant) {
    if (!children[octant].empty()) {
      build(child(key, octant), std::move(children[octant]), points);
    }
  }
}

void OctreeMaker::emit(CopcNode node) {
  nodes_.push_back(std::move(node));
  if (nodes_.size() == kNodesAtATime) {
    flush();
  }
}

void OctreeMaker::flush() {
  (*take_)(nodes_);
  nodes_.clear();
}

void OctreeMaker::finish() {
  for (auto& [key, node] : coarse_) {
    emit({.key = key, .points = std::move(node.points)});
  }
  flush();
}

}  // namespace

CopcCube::Place CopcCube::place_of(const char* point) const {
  std::array<int32_t, 3> steps{};
  std::memcpy(steps.data(), point, sizeof(steps));
  Place place{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis] = kParts * static_cast<uint64_t>(int64_t{steps[axis]} - int64_t{lowest[axis]}) + 1;
  }
  return place;
}

VoxelKey CopcCube::key_of(const Place& place, int32_t level) const {
  const auto at = [&](std::size_t axis) {
    return static_cast<int32_t>((place[axis] << level) / side);
  };
  return {level, at(0), at(1), at(2)};
}

uint32_t CopcCube::cell_of(const Place& place, int32_t level) const {
  uint32_t cell = 0;
  for (const uint64_t along : place) {
    const uint64_t in_all = (along << level) * kCopcCells / side;
    cell = cell * kCopcCells + static_cast<uint32_t>(in_all % kCopcCells);
  }
  return cell;
}

CopcCube cube_of(const LasExtent& extent) {
  CopcCube cube{.lowest = extent.lowest};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int64_t length = int64_t{extent.highest[axis]} - int64_t{extent.lowest[axis]};
    cube.side = std::max(cube.side, CopcCube::kParts * (static_cast<uint64_t>(length) + 1));
  }
  return cube;
}

void visit_copc_nodes(const CopcPoints& points, const CopcCube& cube, const CopcLimits& limits,
                      const TakeNodes& take) {
  const std::size_t size = points.point_bytes;
  OctreeMaker maker(cube, limits, size, take);
  const auto visit = [&](const auto& self, const CopcPoints& from, const Part& part) -> void {
    if (part.points <= limits.part || part.root.level == kDeepestLevel) {
      std::string bytes(part.points * size, '\0');
      from.file->read_at(part.begin * size, bytes);
      maker.add(part, bytes);
      return;
    }
    const Parts parts = parts_of(from, part, cube, limits.part);
    ScratchFile sorted(points.file->beside());
    sort_by_part(from, part, cube, parts, sorted);
    for (const Part& one : parts.parts) {
      self(self, {.file = &sorted, .point_bytes = size}, one);
    }
  };
  visit(visit, points, {.points = points.file->size() / size});
  maker.finish();
}

}  // namespace adit
