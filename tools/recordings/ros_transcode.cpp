// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_transcode.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "adit/tools/recordings/ros_visit.hpp"

namespace adit::ros {
namespace {

template <class Message>
std::vector<std::byte> through(Encoding from, std::span<const std::byte> bytes, Encoding to) {
  return encode(to, decode<Message>(from, bytes));
}

struct Entry {
  std::string_view type;
  std::vector<std::byte> (*transcode)(Encoding, std::span<const std::byte>, Encoding);
};
template <class Message>
constexpr Entry entry() {
  return {Message::kType, through<Message>};
}
constexpr std::array kEntries = {entry<PointCloud2>(),
                                 entry<Imu>(),
                                 entry<NavSatFix>(),
                                 entry<Odometry>(),
                                 entry<PoseStamped>(),
                                 entry<TransformStamped>(),
                                 entry<TFMessage>(),
                                 entry<LivoxCustomMsg>(),
                                 entry<Image>(),
                                 entry<CompressedImage>(),
                                 entry<CameraInfo>(),
                                 entry<VelodyneScan>(),
                                 entry<TwistStamped>(),
                                 entry<TwistWithCovarianceStamped>(),
                                 entry<QuaternionStamped>(),
                                 entry<Sentence>()};

const Entry* find(std::string_view type) {
  if (type == "tf/tfMessage") {
    type = TFMessage::kType;
  } else if (type.starts_with("livox") && type.ends_with("/CustomMsg")) {
    type = LivoxCustomMsg::kType;
  }
  const auto found = std::ranges::find(kEntries, type, &Entry::type);
  return found == kEntries.end() ? nullptr : &*found;
}

}  // namespace

std::optional<std::string> shared_type_name(std::string_view type) {
  const Entry* found = find(type);
  return found == nullptr ? std::nullopt : std::optional(std::string(found->type));
}

std::vector<std::byte> transcode(std::string_view type, Encoding from,
                                 std::span<const std::byte> bytes, Encoding to) {
  const Entry* found = find(type);
  if (found == nullptr) {
    throw std::logic_error("transcode: " + std::string(type) + " is not understood");
  }
  return found->transcode(from, bytes, to);
}

}  // namespace adit::ros
