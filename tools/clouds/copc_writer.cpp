// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// COPC 1.0: the record that describes the octree comes first, so that a reader finds it at a fixed
// byte; the list of nodes is an extended record behind the points.
#include "adit/tools/clouds/copc_writer.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/clouds/copc_octree.hpp"
#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/clouds/laz_writer.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr std::size_t kWaitingBytes = std::size_t{1} << 22;
constexpr std::size_t kExtendedHeaderBytes = 60;

struct NodeEntry {
  VoxelKey key{};
  LazChunk chunk{};
};

/// Where the list of nodes is.
struct NodeList {
  uint64_t begin = 0;  ///< byte of the file
  uint64_t bytes = 0;
};

std::string copc_info(const CopcCube& cube, const LasHeading& heading, const LasExtent& extent,
                      const NodeList& list) {
  const double part = kLasScale / static_cast<double>(CopcCube::kParts);
  const double half = 0.5 * part * static_cast<double>(cube.side);
  std::string info;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    append_raw(info, heading.offset[static_cast<Eigen::Index>(axis)] +
                         kLasScale * cube.lowest[axis] - part + half);
  }
  append_raw(info, half);
  append_raw(info, 2 * half / kCopcCells);
  append_raw(info, list.begin);
  append_raw(info, list.bytes);
  append_raw(info, extent.points == 0 ? 0.0 : extent.earliest);
  append_raw(info, extent.points == 0 ? 0.0 : extent.latest);
  return info.append(11 * sizeof(uint64_t), '\0');
}

LasRecords copc_records(const LasHeading& heading, const std::string& info) {
  LasRecords records;
  records.add("copc", 1, "COPC info", info);
  add_laz_record(records, kLazAnyPoints, las_point_layout(heading));
  add_las_records(records, heading);
  return records;
}

/// An extended record.
std::string node_record(const std::vector<NodeEntry>& nodes) {
  std::string list;
  for (const NodeEntry& node : nodes) {
    append_raw(list, node.key);
    append_raw(list, node.chunk.begin);
    append_raw(list, static_cast<int32_t>(node.chunk.bytes));
    append_raw(list, static_cast<int32_t>(node.chunk.points));
  }
  std::string record;
  append_raw(record, uint16_t{0});
  append_padded(record, "copc", 16);
  append_raw(record, uint16_t{1000});
  append_raw(record, uint64_t{list.size()});
  append_padded(record, "COPC nodes", 32);
  return record.append(list);
}

}  // namespace

CopcWriter::CopcWriter(std::filesystem::path path, LasHeading heading)
    : heading_(std::move(heading)), file_(std::move(path)), points_(file_.path()) {}

void CopcWriter::write(std::span<const LasPoint> points) {
  for (const LasPoint& point : points) {
    append_las_point(waiting_, extent_, point, heading_, file_.path());
  }
  if (waiting_.size() >= kWaitingBytes) {
    points_.append(waiting_);
    waiting_.clear();
  }
}

void CopcWriter::close() {
  points_.append(waiting_);
  const CopcCube cube = cube_of(extent_);
  const auto begin = [&](const NodeList& list, uint64_t extended_begin) {
    const LasRecords records = copc_records(heading_, copc_info(cube, heading_, extent_, list));
    return las_header(heading_, extent_,
                      {.record_bytes = records.bytes.size(),
                       .records = records.count,
                       .packed = true,
                       .extended_begin = extended_begin,
                       .extended = 1}) +
           records.bytes;
  };
  const std::string draft = begin({}, 0);
  file_.write(draft);
  const LasPointLayout layout = las_point_layout(heading_);
  LazChunkWriter chunks(file_, draft.size(), layout);
  std::vector<NodeEntry> nodes;
  visit_copc_nodes({.file = &points_, .point_bytes = layout.bytes()}, cube, {},
                   [&](std::span<const CopcNode> some) {
                     std::vector<std::string_view> points;
                     for (const CopcNode& node : some) {
                       points.emplace_back(node.points);
                     }
                     const std::vector<LazChunk> written = chunks.write(points);
                     for (std::size_t i = 0; i < some.size(); ++i) {
                       nodes.push_back({.key = some[i].key, .chunk = written[i]});
                     }
                   });
  if (nodes.empty()) {
    nodes.push_back({});  // a root without points
  }
  std::ranges::sort(nodes, {}, &NodeEntry::key);
  const uint64_t extended = chunks.finish(LazTable::points_and_sizes);
  const std::string record = node_record(nodes);
  file_.write(record);
  file_.flush();
  file_.overwrite(0, begin({.begin = extended + kExtendedHeaderBytes,
                            .bytes = record.size() - kExtendedHeaderBytes},
                           extended));
  file_.close();
}

}  // namespace adit
