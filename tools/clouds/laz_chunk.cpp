// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_chunk.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/tools/clouds/arithmetic_coder.hpp"
#include "adit/tools/clouds/laz_color.hpp"
#include "adit/tools/clouds/laz_color_layer.hpp"
#include "adit/tools/clouds/laz_series.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

/// Layers of POINT14 in the order of the file.
enum Layer : std::size_t {
  kReturnsAndPlace,
  kHeight,
  kClass,
  kFlags,
  kIntensity,
  kAngle,
  kUser,
  kSource,
  kTime,
  kLayers
};

struct LasPoint14 {
  std::array<int32_t, 3> position{};  ///< steps
  uint16_t intensity = 0;
  uint8_t return_number = 0;
  uint8_t returns = 0;
  uint8_t flags = 0;  ///< four bits of the class, then scan direction and edge of the flight line
  uint8_t channel = 0;
  uint8_t classification = 0;
  uint8_t user = 0;
  uint16_t angle = 0;
  uint16_t source = 0;
  uint64_t time = 0;  ///< bits of a double
};

LasPoint14 load_point14(const char* from) {
  const auto returns = load_raw<uint8_t>(from, 14);
  const auto flags = load_raw<uint8_t>(from, 15);
  return {.position = {load_raw<int32_t>(from, 0), load_raw<int32_t>(from, 4),
                       load_raw<int32_t>(from, 8)},
          .intensity = load_raw<uint16_t>(from, 12),
          .return_number = static_cast<uint8_t>(returns & 15U),
          .returns = static_cast<uint8_t>(returns >> 4U),
          .flags = static_cast<uint8_t>((flags & 15U) | ((flags >> 2U) & 48U)),
          .channel = static_cast<uint8_t>((flags >> 4U) & 3U),
          .classification = load_raw<uint8_t>(from, 16),
          .user = load_raw<uint8_t>(from, 17),
          .angle = load_raw<uint16_t>(from, 18),
          .source = load_raw<uint16_t>(from, 20),
          .time = load_raw<uint64_t>(from, 22)};
}

void store_point14(const LasPoint14& point, char* to) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    store_raw(to, 4 * axis, point.position[axis]);
  }
  store_raw(to, 12, point.intensity);
  store_raw(to, 14, static_cast<uint8_t>(point.return_number | (point.returns << 4U)));
  store_raw(to, 15,
            static_cast<uint8_t>((point.flags & 15U) | (point.channel << 4U) |
                                 ((point.flags & 48U) << 2U)));
  store_raw(to, 16, point.classification);
  store_raw(to, 17, point.user);
  store_raw(to, 18, point.angle);
  store_raw(to, 20, point.source);
  store_raw(to, 22, point.time);
}

/// Which of six contexts a return is in, by its number (column) and the number of returns of its
/// pulse (row): LASzip's table `number_return_map_6ctx`, which has combinations in it that no valid
/// point has.
constexpr std::array<std::string_view, 16> kReturnContexts = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};

std::size_t return_context(const LasPoint14& point) {
  return static_cast<std::size_t>(kReturnContexts[point.returns][point.return_number] - '0');
}

/// How many returns are missing to the last, up to 7.
std::size_t return_level(const LasPoint14& point) {
  const int level = int{point.returns} - int{point.return_number};
  return static_cast<std::size_t>(std::min(std::abs(level), 7));
}

bool is_first_return(const LasPoint14& point) {
  return point.return_number == 1;
}
bool is_last_return(const LasPoint14& point) {
  return point.return_number >= point.returns;
}

std::vector<SymbolModel> models(std::size_t count, uint32_t symbols) {
  return std::vector<SymbolModel>(count, SymbolModel(symbols));
}

/// What is known of the points of one scanner channel.
struct ChannelState {
  explicit ChannelState(const LasPoint14& first)
      : last(first), times(first.time, PulseTimes::change_is_known) {
    heights.fill(first.position[2]);
    intensities.fill(first.intensity);
  }

  LasPoint14 last;
  bool time_changed = false;  ///< with the last point
  std::array<int32_t, 8> heights{};
  std::array<uint16_t, 8> intensities{};
  std::array<std::array<RunningMedian, 12>, 2> steps{};  ///< of x and y
  PulseTimes times;

  std::vector<SymbolModel> changes = models(8, 128);
  SymbolModel channel{3};
  std::vector<SymbolModel> returns = models(16, 16);
  std::vector<SymbolModel> return_number = models(16, 16);
  SymbolModel return_number_of_pulse{13};
  std::vector<SymbolModel> classification = models(64, 256);
  std::vector<SymbolModel> flags = models(64, 64);
  std::vector<SymbolModel> user = models(64, 256);
  IntegerModel x{32, 2};
  IntegerModel y{32, 22};
  IntegerModel z{32, 20};
  IntegerModel intensity{16, 4};
  IntegerModel angle{16, 2};
  IntegerModel source{16, 1};
};

/// Bits of what has changed from the last point of the same scanner channel to this one. The two
/// lowest say how the number of the return did: not, by one up, by one down, otherwise.
enum Change : uint32_t {
  kOtherReturn = 3,
  kReturnsChanged = 4,
  kAngleChanged = 8,
  kTimeChanged = 16,
  kSourceChanged = 32,
  kChannelChanged = 64,
};

uint32_t changes_between(const LasPoint14& last, const LasPoint14& point) {
  const uint32_t up = (point.return_number - last.return_number) & 15U;
  return (up == 0    ? 0U
          : up == 1  ? 1U
          : up == 15 ? 2U
                     : uint32_t{kOtherReturn}) |
         (point.returns != last.returns ? kReturnsChanged : 0U) |
         (point.angle != last.angle ? kAngleChanged : 0U) |
         (point.time != last.time ? kTimeChanged : 0U) |
         (point.source != last.source ? kSourceChanged : 0U);
}

/// Both directions of POINT14: with encoders what goes in comes out, with decoders what comes out
/// is what went in.
template <class Coder>
class Point14Codec {
 public:
  using Coders = std::array<std::optional<Coder>, kLayers>;

  /// Layers without a coder hold nothing: their attribute is that of the first point.
  Point14Codec(Coders coders, const LasPoint14& first)
      : coders_(std::move(coders)), channel_(first.channel) {
    states_[channel_] = std::make_unique<ChannelState>(first);
  }

  LasPoint14 code(const LasPoint14& point);
  Coders& coders() { return coders_; }

 private:
  struct Step {
    uint32_t changes = 0;
    bool has_time() const { return (changes & kTimeChanged) != 0; }
  };

  Step code_changes(const LasPoint14& point);
  void code_returns(const LasPoint14& point, LasPoint14& now, uint32_t changes);
  void code_position(const LasPoint14& point, LasPoint14& now, bool time_changed);
  void code_attributes(const LasPoint14& point, LasPoint14& now, uint32_t changes);

  ChannelState& state() { return *states_[channel_]; }

  Coders coders_;
  std::array<std::unique_ptr<ChannelState>, 4> states_{};
  std::size_t channel_;
};

template <class Coder>
typename Point14Codec<Coder>::Step Point14Codec<Coder>::code_changes(const LasPoint14& point) {
  Coder& coder = *coders_[kReturnsAndPlace];
  ChannelState& before = state();
  uint32_t changes = 0;
  if (Coder::kEncodes) {
    const bool other = point.channel != channel_;
    const ChannelState& same = other && states_[point.channel] ? *states_[point.channel] : before;
    changes = changes_between(same.last, point) | (other ? kChannelChanged : 0U);
  }
  const std::size_t context = (is_first_return(before.last) ? 1U : 0U) +
                              (is_last_return(before.last) ? 2U : 0U) +
                              (before.time_changed ? 4U : 0U);
  changes = coder.symbol(before.changes[context], changes);
  if ((changes & kChannelChanged) != 0) {
    const uint32_t up = (point.channel - static_cast<uint32_t>(channel_) + 3U) & 3U;
    const uint32_t step = coder.symbol(before.channel, Coder::kEncodes ? up : 0);
    channel_ = (channel_ + step + 1) & 3U;
    if (!states_[channel_]) {
      states_[channel_] = std::make_unique<ChannelState>(before.last);
    }
  }
  return {changes};
}

template <class Coder>
void Point14Codec<Coder>::code_returns(const LasPoint14& point, LasPoint14& now, uint32_t changes) {
  Coder& coder = *coders_[kReturnsAndPlace];
  ChannelState& known = state();
  const uint32_t last = known.last.return_number;
  if ((changes & kReturnsChanged) != 0) {
    now.returns =
        static_cast<uint8_t>(coder.symbol(known.returns[known.last.returns], point.returns));
  }
  uint32_t number = last;
  switch (changes & kOtherReturn) {
    case 1:
      number = last + 1;
      break;
    case 2:
      number = last + 15;
      break;
    case kOtherReturn:
      number = (changes & kTimeChanged) != 0
                   ? coder.symbol(known.return_number[last], point.return_number)
                   : last + 2 +
                         coder.symbol(known.return_number_of_pulse,
                                      Coder::kEncodes ? (point.return_number - last - 2) & 15U : 0);
      break;
    default:
      break;
  }
  now.return_number = static_cast<uint8_t>(number & 15U);
}

template <class Coder>
void Point14Codec<Coder>::code_position(const LasPoint14& point, LasPoint14& now,
                                        bool time_changed) {
  Coder& coder = *coders_[kReturnsAndPlace];
  ChannelState& known = state();
  const std::size_t context = 2 * return_context(now) + (time_changed ? 1 : 0);
  const uint32_t single = now.returns == 1 ? 1 : 0;
  const auto step = [&](std::size_t axis) {
    return static_cast<int32_t>(static_cast<uint32_t>(point.position[axis]) -
                                static_cast<uint32_t>(known.last.position[axis]));
  };
  const auto take = [&](std::size_t axis, IntegerModel& model, uint32_t model_context) {
    RunningMedian& median = known.steps[axis][context];
    const int32_t coded = model.code(coder, median.value(), step(axis), model_context);
    median.add(coded);
    now.position[axis] = static_cast<int32_t>(static_cast<uint32_t>(known.last.position[axis]) +
                                              static_cast<uint32_t>(coded));
  };
  take(0, known.x, single);
  take(1, known.y, single + std::min(known.x.width() & ~1U, 20U));
  if (coders_[kHeight]) {
    const uint32_t width = ((known.x.width() + known.y.width()) / 2) & ~1U;
    int32_t& height = known.heights[return_level(now)];
    height =
        known.z.code(*coders_[kHeight], height, point.position[2], single + std::min(width, 18U));
    now.position[2] = height;
  }
}

template <class Coder>
void Point14Codec<Coder>::code_attributes(const LasPoint14& point, LasPoint14& now,
                                          uint32_t changes) {
  ChannelState& known = state();
  const LasPoint14& last = known.last;
  const uint32_t time_changed = (changes & kTimeChanged) != 0 ? 1 : 0;
  const uint32_t place = (is_first_return(now) ? 2U : 0U) + (is_last_return(now) ? 1U : 0U);
  if (auto& coder = coders_[kClass]) {
    const std::size_t context = 2 * (last.classification & 31U) + (place == 3 ? 1 : 0);
    now.classification =
        static_cast<uint8_t>(coder->symbol(known.classification[context], point.classification));
  }
  if (auto& coder = coders_[kFlags]) {
    now.flags = static_cast<uint8_t>(coder->symbol(known.flags[last.flags], point.flags));
  }
  if (auto& coder = coders_[kIntensity]) {
    uint16_t& intensity = known.intensities[2 * place + time_changed];
    intensity =
        static_cast<uint16_t>(known.intensity.code(*coder, intensity, point.intensity, place));
    now.intensity = intensity;
  }
  if (auto& coder = coders_[kAngle]; coder && (changes & kAngleChanged) != 0) {
    now.angle =
        static_cast<uint16_t>(known.angle.code(*coder, last.angle, point.angle, time_changed));
  }
  if (auto& coder = coders_[kUser]) {
    now.user = static_cast<uint8_t>(coder->symbol(known.user[last.user / 4], point.user));
  }
  if (auto& coder = coders_[kSource]; coder && (changes & kSourceChanged) != 0) {
    now.source = static_cast<uint16_t>(known.source.code(*coder, last.source, point.source, 0));
  }
  if (auto& coder = coders_[kTime]; coder && time_changed != 0) {
    now.time = known.times.code(*coder, point.time);
  }
}

template <class Coder>
LasPoint14 Point14Codec<Coder>::code(const LasPoint14& point) {
  const Step step = code_changes(point);
  LasPoint14 now = state().last;
  now.channel = static_cast<uint8_t>(channel_);
  code_returns(point, now, step.changes);
  code_position(point, now, step.has_time());
  code_attributes(point, now, step.changes);
  state().last = now;
  state().time_changed = step.has_time();
  return now;
}

/// Whether the bytes from `at` on differ from one point to another, in the bits of `mask`.
bool differs(std::string_view points, std::size_t point_bytes, std::size_t at, std::size_t size,
             unsigned char mask = 0xff) {
  for (std::size_t i = point_bytes; i < points.size(); i += point_bytes) {
    for (std::size_t byte = at; byte < at + size; ++byte) {
      if (((points[i + byte] ^ points[byte]) & mask) != 0) {
        return true;
      }
    }
  }
  return false;
}

/// Encoders of the layers in which anything differs; places always have theirs.
Point14Codec<ArithmeticEncoder>::Coders encoders_for(std::string_view points,
                                                     std::size_t point_bytes) {
  const auto if_differs = [&](std::size_t at, std::size_t size, unsigned char mask = 0xff) {
    return differs(points, point_bytes, at, size, mask) ? std::make_optional<ArithmeticEncoder>()
                                                        : std::nullopt;
  };
  Point14Codec<ArithmeticEncoder>::Coders coders;
  coders[kReturnsAndPlace].emplace();
  coders[kHeight].emplace();
  coders[kClass] = if_differs(16, 1);
  coders[kFlags] = if_differs(15, 1, 0xcf);
  coders[kIntensity] = if_differs(12, 2);
  coders[kAngle] = if_differs(18, 2);
  coders[kUser] = if_differs(17, 1);
  coders[kSource] = if_differs(20, 2);
  coders[kTime] = if_differs(22, 8);
  return coders;
}

/// The layer of an extra byte: by its difference to that of the point before.
std::string pack_extra_byte(std::string_view points, std::size_t point_bytes, std::size_t at) {
  if (!differs(points, point_bytes, at, 1)) {
    return {};
  }
  ArithmeticEncoder encoder;
  SymbolModel model(256);
  for (std::size_t i = point_bytes + at; i < points.size(); i += point_bytes) {
    encoder.symbol(model, static_cast<uint8_t>(points[i] - points[i - point_bytes]));
  }
  return encoder.finish();
}

/// The layer of all colours.
std::string pack_colors(std::string_view points, std::size_t point_bytes) {
  if (!differs(points, point_bytes, kLas6Bytes, kLasColorBytes)) {
    return {};
  }
  ArithmeticEncoder encoder;
  LazColorCodec codec;
  const auto color_of = [&](std::size_t point) {
    return load_raw<LazColor>(points.data(), point + kLas6Bytes);
  };
  for (std::size_t at = point_bytes; at < points.size(); at += point_bytes) {
    codec.code(encoder, color_of(at - point_bytes), color_of(at));
  }
  return encoder.finish();
}

}  // namespace

std::string pack_laz_chunk(std::string_view points, const LasPointLayout& layout) {
  const std::size_t point_bytes = layout.bytes();
  const LasPoint14 first = load_point14(points.data());
  Point14Codec<ArithmeticEncoder> codec(encoders_for(points, point_bytes), first);
  for (std::size_t at = point_bytes; at < points.size(); at += point_bytes) {
    codec.code(load_point14(points.data() + at));
  }
  std::vector<std::string> layers;
  for (std::optional<ArithmeticEncoder>& coder : codec.coders()) {
    layers.push_back(coder ? coder->finish() : std::string());
  }
  if (layout.colored) {
    layers.push_back(pack_colors(points, point_bytes));
  }
  for (std::size_t at = layout.extra_at(); at < point_bytes; ++at) {
    layers.push_back(pack_extra_byte(points, point_bytes, at));
  }
  std::string chunk(points.substr(0, point_bytes));
  append_raw(chunk, static_cast<uint32_t>(points.size() / point_bytes));
  for (const std::string& layer : layers) {
    append_raw(chunk, static_cast<uint32_t>(layer.size()));
  }
  for (const std::string& layer : layers) {
    chunk += layer;
  }
  return chunk;
}

UnpackedChunk unpack_laz_chunk(std::span<const std::byte> chunk, std::size_t count,
                               const LazChunkLayout& layout) {
  const std::size_t sizes_at = layout.point_bytes + sizeof(uint32_t);
  std::size_t at = sizes_at + layout.layers * sizeof(uint32_t);
  UnpackedChunk unpacked;
  if (layout.point_bytes < layout.unpacked_bytes() ||
      layout.layers < kLayers + (layout.colored ? 1 : 0) || chunk.size() < at || count == 0) {
    return unpacked;
  }
  const char* const bytes = reinterpret_cast<const char*>(chunk.data());
  bool is_whole = load_raw<uint32_t>(bytes, layout.point_bytes) == count;
  Point14Codec<ArithmeticDecoder>::Coders coders;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    const std::size_t size = load_raw<uint32_t>(bytes, sizes_at + layer * sizeof(uint32_t));
    const std::size_t there = std::min(size, chunk.size() - std::min(at, chunk.size()));
    is_whole = is_whole && there == size;
    if (size > 0 || layer == kReturnsAndPlace) {
      coders[layer].emplace(chunk.subspan(std::min(at, chunk.size()), there));
    }
    at += size;
  }
  Point14Codec<ArithmeticDecoder> codec(std::move(coders), load_point14(bytes));
  unpacked.points.assign(bytes, kLas6Bytes);
  std::array<char, kLas6Bytes> point{};
  for (std::size_t i = 1; i < count && !codec.coders()[kReturnsAndPlace]->is_overrun(); ++i) {
    store_point14(codec.code({}), point.data());
    unpacked.points.append(point.data(), point.size());
  }
  unpacked.is_whole = is_whole && std::ranges::none_of(codec.coders(), [](const auto& coder) {
                        return coder && coder->is_overrun();
                      });
  if (layout.colored) {
    const std::size_t size = load_raw<uint32_t>(bytes, sizes_at + kLayers * sizeof(uint32_t));
    const std::size_t there = std::min(size, chunk.size() - std::min(at, chunk.size()));
    ColorLayer layer(chunk.subspan(std::min(at, chunk.size()), there),
                     load_raw<LazColor>(bytes, kLas6Bytes), scanner_channel(bytes));
    unpacked.points = with_colors(unpacked.points, {bytes, layout.point_bytes}, layer);
    unpacked.is_whole = unpacked.is_whole && there == size && !layer.is_overrun();
  }
  return unpacked;
}

}  // namespace adit
