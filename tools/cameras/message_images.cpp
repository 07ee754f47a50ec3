// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/message_images.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/cameras/message_pixels.hpp"
#include "adit/tools/recordings/message_times.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

/// Where a message is.
struct MessagePlace {
  Nanoseconds stamp{0};
  Nanoseconds received{0};
  uint64_t offset = 0;    ///< RawMessage::offset
  uint32_t file = 0;      ///< index
  uint32_t repeat = 0;    ///< how many of the topic are before it of the same offset and receipt
  uint32_t sequence = 0;  ///< place among the topic's messages of the file
};

/// Counts the messages of a topic that neither offset nor receipt tell apart.
class RepeatCounter {
 public:
  uint32_t operator()(uint64_t offset, Nanoseconds received) {
    if (offset != offset_) {
      seen_.clear();
      offset_ = offset;
    }
    return seen_[received]++;
  }

 private:
  uint64_t offset_ = 0;
  std::map<Nanoseconds, uint32_t> seen_;
};

std::vector<std::size_t> channels_of(const MessageFile& file, const std::string& topic) {
  std::vector<std::size_t> channels;
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    if (file.channels()[i].topic == topic && has_images(file.channels()[i])) {
      channels.push_back(i);
    }
  }
  return channels;
}

/// One after the other from a place on: an image that follows the last one costs no search.
class PlaceReader {
 public:
  explicit PlaceReader(const std::vector<std::unique_ptr<MessageFile>>& files, std::string topic)
      : files_(&files), topic_(std::move(topic)) {}

  /// The bytes until the next call; nothing where the file has it no more. Throws InputError.
  std::optional<RawMessage> read(const MessagePlace& place) {
    const bool follows = stream_ && at_.file == place.file && at_.sequence < place.sequence &&
                         (at_.offset == place.offset || at_.sequence + 1 == place.sequence);
    std::optional<RawMessage> message = follows ? search_behind(place) : std::nullopt;
    if (!message) {
      open(place);
      message = search(place);
    }
    at_ = place;
    return message;
  }

 private:
  void open(const MessagePlace& place) {
    const MessageFile& file = *(*files_)[place.file];
    stream_ = file.messages({.channels = channels_of(file, topic_),
                             .begin = place.received,
                             .from = place.offset,
                             .by_index = true});
    repeats_ = {};
  }

  /// Nothing also where the bytes between are damaged.
  std::optional<RawMessage> search_behind(const MessagePlace& place) {
    try {
      return search(place);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  std::optional<RawMessage> search(const MessagePlace& place) {
    while (std::optional<RawMessage> message = stream_->next()) {
      const uint32_t repeat = repeats_(message->offset, message->received);
      if (message->offset != place.offset) {
        break;
      }
      if (message->received == place.received && repeat == place.repeat) {
        return message;
      }
    }
    return std::nullopt;
  }

  const std::vector<std::unique_ptr<MessageFile>>* files_;
  std::string topic_;
  std::unique_ptr<MessageStream> stream_;
  RepeatCounter repeats_;
  MessagePlace at_;
};

class MessageImages final : public ImageSeries {
 public:
  MessageImages(SharedMessageFiles files, const std::string& topic,
                std::vector<MessagePlace> places)
      : files_(std::move(files)),
        topic_(topic),
        places_(std::move(places)),
        reader_(*files_, topic) {
    std::ranges::stable_sort(places_, {}, &MessagePlace::stamp);
    stamps_.reserve(places_.size());
    for (const MessagePlace& place : places_) {
      stamps_.push_back(place.stamp);
    }
  }

  std::span<const Nanoseconds> stamps() const override { return stamps_; }

  ColorImage image(std::size_t index) const override {
    const MessagePlace& place = places_.at(index);
    const MessageFile& file = *(*files_)[place.file];
    const auto fail = [&](const std::string& found) -> ColorImage {
      throw InputError(
          file.path(), Place::byte(place.offset),
          "of the images on " + topic_ + ", number " + std::to_string(index) + ": " + found,
          "The image is damaged, or of a kind that is not read");
    };
    const Bytes bytes = read(place);
    const Channel& channel = file.channels()[bytes.channel];
    try {
      return channel.type == ros::Image::kType
                 ? ros::to_color(ros::decode<ros::Image>(channel.encoding, bytes.content))
                 : ros::to_color(
                       ros::decode<ros::CompressedImage>(channel.encoding, bytes.content));
    } catch (const ImageError& error) {
      return fail(error.what());
    } catch (const ros::CodecError& error) {
      return fail(error.what());
    }
  }

 private:
  struct Bytes {
    std::size_t channel = 0;
    std::vector<std::byte> content;
  };

  Bytes read(const MessagePlace& place) const {
    const std::scoped_lock lock(reading_);
    const std::optional<RawMessage> message = reader_.read(place);
    if (!message) {
      throw InputError((*files_)[place.file]->path(), Place::byte(place.offset),
                       "an image on " + topic_ + " that was here is here no more",
                       "The file was changed while adit read it: run again");
    }
    return {message->channel, {message->bytes.begin(), message->bytes.end()}};
  }

  SharedMessageFiles files_;
  std::string topic_;
  std::vector<MessagePlace> places_;
  std::vector<Nanoseconds> stamps_;
  mutable std::mutex reading_;
  mutable PlaceReader reader_;
};

/// What the pass over the recording collects of a topic.
struct TopicPlaces {
  std::vector<MessagePlace> places;
  RepeatCounter repeats;
  uint32_t sequence = 0;
};

/// The next message that is not damaged; nothing at the end.
std::optional<RawMessage> next_sound(MessageStream& stream) {
  while (true) {
    try {
      return stream.next();
    } catch (const InputError&) {
      // reported where the recording is read
    }
  }
}

void collect(const MessageFile& file, uint32_t number, const std::vector<std::string>& topics,
             std::vector<TopicPlaces>& found) {
  std::map<std::size_t, std::size_t> topic_of;  // by channel
  std::vector<std::size_t> channels;
  for (std::size_t topic = 0; topic < topics.size(); ++topic) {
    found[topic].repeats = {};
    found[topic].sequence = 0;
    for (const std::size_t channel : channels_of(file, topics[topic])) {
      topic_of[channel] = topic;
      channels.push_back(channel);
    }
  }
  if (channels.empty()) {
    return;
  }
  const auto stream = file.messages({.channels = channels, .by_index = true});
  while (const std::optional<RawMessage> message = next_sound(*stream)) {
    TopicPlaces& topic = found[topic_of.at(message->channel)];
    topic.places.push_back(
        {.stamp = stamp_in(file.channels()[message->channel], *message).value_or(message->received),
         .received = message->received,
         .offset = message->offset,
         .file = number,
         .repeat = topic.repeats(message->offset, message->received),
         .sequence = topic.sequence++});
  }
}

}  // namespace

bool has_images(const Channel& channel) {
  return channel.encoding != Encoding::other &&
         (channel.type == ros::Image::kType || channel.type == ros::CompressedImage::kType);
}

std::vector<std::shared_ptr<const ImageSeries>> read_message_images(
    const SharedMessageFiles& files, const std::vector<std::string>& topics) {
  std::vector<TopicPlaces> found(topics.size());
  for (std::size_t i = 0; i < files->size(); ++i) {
    collect(*(*files)[i], static_cast<uint32_t>(i), topics, found);
  }
  std::vector<std::shared_ptr<const ImageSeries>> series;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    series.push_back(std::make_shared<MessageImages>(files, topics[i], std::move(found[i].places)));
  }
  return series;
}

}  // namespace adit
