// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/disk_reserve.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMostReserve = uint64_t{1} << 30U;  // bytes
constexpr uint64_t kLookAfter = uint64_t{1} << 20U;    // bytes written; it takes microseconds
// The results of an hour of VLP-16 (map, cloud, tables) take 0.09 of its recording, of sensors with
// more points less: their map keeps one for each voxel.
constexpr uint64_t kRecordingForResults = 8;
constexpr uint64_t kFreedAtOnce = uint64_t{1} << 20U;  // bytes

}  // namespace

DiskReserve::~DiskReserve() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

void DiskReserve::begin(const fs::path& recording, std::function<void(const std::string&)> say,
                        std::optional<uint64_t> least) {
  const std::scoped_lock lock(mutex_);
  std::error_code unknown;
  const fs::space_info disk = fs::space(recording, unknown);
  recording_ = recording;
  say_ = std::move(say);
  least_ = least.value_or(unknown ? 0 : std::min<uint64_t>(disk.capacity / 10, kMostReserve));
}

void DiskReserve::written(uint64_t end) {
  const std::scoped_lock lock(mutex_);
  if (least_ == 0 || kept_ || end < looked_ + kLookAfter) {
    return;
  }
  looked_ = end;
  std::error_code unknown;
  const fs::space_info disk = fs::space(recording_, unknown);
  if (unknown || disk.available >= least_ + end / kRecordingForResults) {
    return;
  }
  kept_ = end;
  freed_ = end;
  if (say_) {
    say_(fmt::format("{} MB of the disk are free: recording stops, mapping goes on",
                     disk.available / 1'000'000));
  }
}

std::optional<uint64_t> DiskReserve::kept() const {
  const std::scoped_lock lock(mutex_);
  return kept_;
}

void DiskReserve::cut() {
  const std::scoped_lock lock(mutex_);
  if (kept_) {
    std::error_code ignored;
    fs::resize_file(recording_, *kept_, ignored);
  }
}

void DiskReserve::free_what_is_read() {
  if (!kept_ || readers_.empty()) {
    return;
  }
  const uint64_t end = *std::ranges::min_element(readers_);
  if (end < freed_ + kFreedAtOnce) {
    return;
  }
  if (descriptor_ < 0) {
    descriptor_ = ::open(recording_.c_str(), O_WRONLY | O_CLOEXEC);
  }
  // Whole blocks alone are freed. A file system that cannot do it keeps them.
  if (::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                  static_cast<off_t>(freed_), static_cast<off_t>(end - freed_)) == 0) {
    freed_ = end;
  }
}

DiskReserve::Reader::Reader(DiskReserve& reserve, uint64_t at) : reserve_(&reserve) {
  const std::scoped_lock lock(reserve_->mutex_);
  place_ = reserve_->readers_.insert(reserve_->readers_.end(), at);
}

DiskReserve::Reader::~Reader() {
  const std::scoped_lock lock(reserve_->mutex_);
  reserve_->readers_.erase(place_);
}

uint64_t DiskReserve::Reader::read(uint64_t at) {
  const std::scoped_lock lock(reserve_->mutex_);
  if (reserve_->kept_ && at >= *reserve_->kept_ && at < reserve_->freed_) {
    at = reserve_->freed_;
  }
  *place_ = at;
  reserve_->free_what_is_read();
  return at;
}

}  // namespace adit
