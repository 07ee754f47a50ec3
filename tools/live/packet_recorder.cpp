// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/packet_recorder.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kIpHeader = 20;
constexpr std::size_t kUdpHeader = 8;

void put_native(std::vector<std::byte>& bytes, uint32_t value) {
  const auto raw = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

void put_network(std::vector<std::byte>& bytes, uint64_t value, int count) {
  for (int i = count - 1; i >= 0; --i) {
    bytes.push_back(static_cast<std::byte>((value >> (8U * static_cast<unsigned>(i))) & 0xffU));
  }
}

}  // namespace

PacketRecorder::PacketRecorder(std::filesystem::path path, const RecordingSplit& split)
    : parts_(std::move(path), split) {
  open();
}

void PacketRecorder::open() {
  path_ = parts_.path();
  committed_ = 0;
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor_ < 0) {
    throw OutputError(path_, path_.string() + ": cannot be created: " + std::strerror(errno));
  }
  put_native(pending_, 0xa1b23c4d);  // nanoseconds
  put_native(pending_, 2U | (4U << 16U));
  put_native(pending_, 0);
  put_native(pending_, 0);
  put_native(pending_, 1U << 16U);  // the snap length
  put_native(pending_, 101);        // LINKTYPE_RAW
  write_pending();
}

PacketRecorder::~PacketRecorder() {
  ::close(descriptor_);
}

void PacketRecorder::add(const ReceivedDatagram& datagram) {
  const std::scoped_lock lock(mutex_);
  if (finished_) {
    return;
  }
  if (parts_.advance(datagram.received, committed_ + pending_.size())) {
    write_pending();
    ::close(descriptor_);
    open();
  }
  const std::size_t udp = kUdpHeader + datagram.payload.size();
  const std::size_t size = kIpHeader + udp;
  const auto ns = static_cast<uint64_t>(datagram.received.count());
  put_native(pending_, static_cast<uint32_t>(ns / 1'000'000'000U));
  put_native(pending_, static_cast<uint32_t>(ns % 1'000'000'000U));
  put_native(pending_, static_cast<uint32_t>(size));
  put_native(pending_, static_cast<uint32_t>(size));
  put_network(pending_, 0x4500, 2);  // IPv4, a header of five words
  put_network(pending_, size, 2);
  put_network(pending_, 0, 4);       // no fragments
  put_network(pending_, 0x4011, 2);  // 64 hops, UDP
  put_network(pending_, 0, 2);       // no checksum
  put_network(pending_, datagram.sender, 4);
  put_network(pending_, datagram.receiver, 4);
  put_network(pending_, datagram.sender_port, 2);
  put_network(pending_, datagram.receiver_port, 2);
  put_network(pending_, udp, 2);
  put_network(pending_, 0, 2);
  pending_.insert(pending_.end(), datagram.payload.begin(), datagram.payload.end());
}

void PacketRecorder::commit() {
  const std::scoped_lock lock(mutex_);
  write_pending();
}

void PacketRecorder::write_pending() {
  std::size_t done = 0;
  while (done < pending_.size()) {
    const ssize_t count = ::write(descriptor_, pending_.data() + done, pending_.size() - done);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      throw OutputError(path_, path_.string() + ": cannot be written: " + std::strerror(errno));
    }
    done += static_cast<std::size_t>(count);
  }
  committed_ += pending_.size();
  reserve_->written(committed_);
  pending_.clear();
}

}  // namespace adit
