// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/las_writer.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {

LasWriter::LasWriter(std::filesystem::path path, LasHeading heading, LasPacking packing)
    : heading_(std::move(heading)), layout_(las_point_layout(heading_)), file_(std::move(path)) {
  const bool packed = packing == LasPacking::laz;
  if (packed) {
    add_laz_record(records_, kLazChunkPoints, layout_);
  }
  add_las_records(records_, heading_);
  const std::string first = header();
  file_.write(first);
  file_.write(records_.bytes);
  if (packed) {
    chunks_.emplace(file_, first.size() + records_.bytes.size(), layout_);
  }
}

std::string LasWriter::header() const {
  return las_header(heading_, extent_,
                    {.record_bytes = records_.bytes.size(),
                     .records = records_.count,
                     .packed = chunks_.has_value()});
}

void LasWriter::write(std::span<const LasPoint> points) {
  waiting_.reserve(waiting_.size() + points.size() * layout_.bytes());
  for (const LasPoint& point : points) {
    append_las_point(waiting_, extent_, point, heading_, file_.path());
  }
  if (chunks_) {
    write_chunks(false);
  } else {
    file_.write(waiting_);
    waiting_.clear();
  }
}

void LasWriter::write_chunks(bool all) {
  const std::size_t chunk_bytes = kLazChunkPoints * layout_.bytes();
  // As many as are packed at the same time.
  const std::size_t together = parallel_pieces() * chunk_bytes;
  const std::size_t whole = all ? waiting_.size() : waiting_.size() / together * together;
  std::vector<std::string_view> chunks;
  for (std::size_t at = 0; at < whole; at += chunk_bytes) {
    chunks.push_back(std::string_view(waiting_).substr(at, std::min(chunk_bytes, whole - at)));
  }
  chunks_->write(chunks);
  waiting_.erase(0, whole);
}

void LasWriter::close() {
  if (chunks_) {
    write_chunks(true);
    chunks_->finish(LazTable::sizes);
  }
  file_.flush();
  file_.overwrite(0, header());
  file_.close();
}

}  // namespace adit
