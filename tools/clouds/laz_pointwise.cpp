// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_pointwise.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/laz_color.hpp"
#include "adit/tools/clouds/laz_series.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr std::size_t kPlainBytes = 20;
constexpr std::size_t kTimeBytes = 8;

/// LASzip's table `number_return_map`: the context of a return by its number (column) and that of
/// its pulse's returns (row).
constexpr std::array<std::string_view, 8> kPulseContexts = {
    "fedcba98", "e0136aa9", "d1247bba", "c3458ccb", "b6789ddc", "aabcdeed", "9abcdefe", "89abcdef"};

std::vector<SymbolModel> byte_models(std::size_t count) {
  return std::vector<SymbolModel>(count, SymbolModel(256));
}

/// POINT10.
class PlainDecoder {
 public:
  /// Changes the point before, in the first 20 bytes, into the next.
  void next(ArithmeticDecoder& decoder, std::string& point);

 private:
  void next_attributes(ArithmeticDecoder& decoder, std::string& point, uint32_t changes);
  void next_position(ArithmeticDecoder& decoder, std::string& point);
  static std::size_t number_of(const std::string& point) {
    return load_raw<uint8_t>(point.data(), 14) & 7U;
  }
  static std::size_t returns_of(const std::string& point) {
    return (load_raw<uint8_t>(point.data(), 14) >> 3U) & 7U;
  }
  static uint32_t context_of(const std::string& point) {
    const char digit = kPulseContexts[returns_of(point)][number_of(point)];
    return static_cast<uint32_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10);
  }

  std::array<uint16_t, 16> intensities_{};
  std::array<std::array<RunningMedian, 16>, 2> steps_{};  ///< of x and y
  std::array<int32_t, 8> heights_{};
  SymbolModel changes_{64};
  std::vector<SymbolModel> returns_ = byte_models(256);
  std::vector<SymbolModel> classification_ = byte_models(256);
  std::vector<SymbolModel> angle_ = byte_models(2);
  std::vector<SymbolModel> user_ = byte_models(256);
  IntegerModel intensity_{16, 4};
  IntegerModel source_{16, 1};
  IntegerModel x_{32, 2};
  IntegerModel y_{32, 22};
  IntegerModel z_{32, 20};
};

void PlainDecoder::next(ArithmeticDecoder& decoder, std::string& point) {
  const uint32_t changes = decoder.symbol(changes_);
  if (changes != 0) {
    next_attributes(decoder, point, changes);
  }
  next_position(decoder, point);
}

void PlainDecoder::next_attributes(ArithmeticDecoder& decoder, std::string& point,
                                   uint32_t changes) {
  const auto byte = [&](std::size_t at) { return load_raw<uint8_t>(point.data(), at); };
  if ((changes & 32U) != 0) {
    store_raw(point.data(), 14, static_cast<uint8_t>(decoder.symbol(returns_[byte(14)])));
  }
  const uint32_t context = context_of(point);
  if ((changes & 16U) != 0) {
    intensities_[context] = static_cast<uint16_t>(
        intensity_.code(decoder, intensities_[context], 0, std::min(context, 3U)));
  }
  store_raw(point.data(), 12, intensities_[context]);
  if ((changes & 8U) != 0) {
    store_raw(point.data(), 15, static_cast<uint8_t>(decoder.symbol(classification_[byte(15)])));
  }
  if ((changes & 4U) != 0) {
    const uint32_t step = decoder.symbol(angle_[(byte(14) >> 6U) & 1U]);
    store_raw(point.data(), 16, static_cast<uint8_t>(byte(16) + step));
  }
  if ((changes & 2U) != 0) {
    store_raw(point.data(), 17, static_cast<uint8_t>(decoder.symbol(user_[byte(17)])));
  }
  if ((changes & 1U) != 0) {
    store_raw(
        point.data(), 18,
        static_cast<uint16_t>(source_.code(decoder, load_raw<uint16_t>(point.data(), 18), 0, 0)));
  }
}

void PlainDecoder::next_position(ArithmeticDecoder& decoder, std::string& point) {
  const uint32_t context = context_of(point);
  const uint32_t single = returns_of(point) == 1 ? 1 : 0;
  const auto step = [&](std::size_t axis, IntegerModel& model, uint32_t model_context) {
    RunningMedian& median = steps_[axis][context];
    const int32_t difference = model.code(decoder, median.value(), 0, model_context);
    median.add(difference);
    store_raw(point.data(), 4 * axis,
              load_raw<uint32_t>(point.data(), 4 * axis) + static_cast<uint32_t>(difference));
  };
  step(0, x_, single);
  step(1, y_, single + std::min(x_.width() & ~1U, 20U));
  const auto level = static_cast<std::size_t>(
      std::abs(static_cast<int>(returns_of(point)) - static_cast<int>(number_of(point))));
  const uint32_t width = ((x_.width() + y_.width()) / 2) & ~1U;
  heights_[level] = z_.code(decoder, heights_[level], 0, single + std::min(width, 18U));
  store_raw(point.data(), 8, heights_[level]);
}

}  // namespace

UnpackedChunk unpack_pointwise_chunk(std::span<const std::byte> chunk, std::size_t count,
                                     const PointwiseLayout& layout) {
  const std::size_t color_at = kPlainBytes + (layout.has_time ? kTimeBytes : 0);
  const std::size_t extra_at = color_at + (layout.has_color ? kLasColorBytes : 0);
  const std::size_t point_bytes = extra_at + layout.extra_bytes;
  UnpackedChunk unpacked;
  if (chunk.size() < point_bytes || count == 0) {
    return unpacked;
  }
  std::string point(reinterpret_cast<const char*>(chunk.data()), point_bytes);
  unpacked.points = point;
  ArithmeticDecoder decoder(chunk.subspan(point_bytes));
  PlainDecoder plain;
  PulseTimes times(layout.has_time ? load_raw<uint64_t>(point.data(), kPlainBytes) : 0,
                   PulseTimes::unchanged_is_coded);
  LazColorCodec color;
  std::vector<SymbolModel> extra = byte_models(layout.extra_bytes);
  store_raw(point.data(), 12, uint16_t{0});  // intensities are coded by what was coded before
  for (std::size_t i = 1; i < count && !decoder.is_overrun(); ++i) {
    plain.next(decoder, point);
    if (layout.has_time) {
      store_raw(point.data(), kPlainBytes, times.code(decoder, 0));
    }
    if (layout.has_color) {
      const auto last = load_raw<LazColor>(point.data(), color_at);
      store_raw(point.data(), color_at, color.code(decoder, last, {}));
    }
    for (std::size_t byte = 0; byte < layout.extra_bytes; ++byte) {
      const std::size_t at = extra_at + byte;
      store_raw(
          point.data(), at,
          static_cast<uint8_t>(load_raw<uint8_t>(point.data(), at) + decoder.symbol(extra[byte])));
    }
    unpacked.points += point;
  }
  unpacked.is_whole = !decoder.is_overrun();
  return unpacked;
}

}  // namespace adit
