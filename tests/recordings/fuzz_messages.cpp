// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The entry that a fuzzer calls with bytes that might be a ROS message: the first byte chooses type
// and encoding. What is read must be written as bytes that are read to the same. `./dev
// fuzz` is the fuzzer.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <type_traits>
#include <vector>

#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_images.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace {

using adit::Encoding;

template <class Message>
void feed(Encoding encoding, std::span<const std::byte> bytes) {
  Message message;
  try {
    message = adit::ros::decode<Message>(encoding, bytes);
  } catch (const adit::ros::CodecError&) {
    return;
  }
  const adit::Channel channel{.topic = "/t",
                              .type = std::string(Message::kType),
                              .encoding = encoding,
                              .definition = {},
                              .messages = {}};
  static const adit::DepthCamera camera(
      {.width = 3, .height = 2, .fx = 100.0, .fy = 100.0, .cx = 1.0, .cy = 0.5});
  try {
    adit::ros::to_events(
        channel, {0, adit::Nanoseconds(1), bytes, 0}, "input",
        {.coordinate_scale = bytes.size() % 2 == 0 ? std::optional(0.001) : std::nullopt}, &camera);
    if constexpr (std::is_same_v<Message, adit::ros::Odometry>) {
      adit::ros::to_velocity(channel, {0, adit::Nanoseconds(1), bytes, 0});
    }
    if constexpr (std::is_same_v<Message, adit::ros::CameraInfo>) {
      const adit::CameraModel model = adit::ros::to_camera(message, false);
      if (model.width * model.height < 4096) {  // a real camera's millions take their time
        const adit::DepthCamera other(model);
      }
    }
  } catch (const adit::ros::CodecError&) {
    // a message that makes no sense
  } catch (const adit::InputError&) {
    // points that make no sense
  }
  std::vector<std::byte> written;
  try {
    written = adit::ros::encode(encoding, message);
  } catch (const adit::ros::CodecError&) {
    return;  // nanoseconds beyond a second push the time out of range
  }
  if (adit::ros::encode(encoding, adit::ros::decode<Message>(encoding, written)) != written) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  using namespace adit::ros;
  constexpr void (*kFeeds[])(Encoding, std::span<const std::byte>) = {
      feed<PointCloud2>,       feed<Imu>,          feed<NavSatFix>,
      feed<Odometry>,          feed<PoseStamped>,  feed<TFMessage>,
      feed<LivoxCustomMsg>,    feed<Image>,        feed<CameraInfo>,
      feed<VelodyneScan>,      feed<TwistStamped>, feed<TwistWithCovarianceStamped>,
      feed<QuaternionStamped>, feed<Sentence>,     feed<CompressedImage>};
  const std::size_t type = (data[0] / 2U) % std::size(kFeeds);
  kFeeds[type](data[0] % 2 == 0 ? Encoding::ros1 : Encoding::cdr,
               std::as_bytes(std::span(data + 1, size - 1)));
  return 0;
}
