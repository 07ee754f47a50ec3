// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/velodyne_packets.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/packets/packet_bytes.hpp"

namespace adit {
namespace {

constexpr std::size_t kDataBytes = 1206;
constexpr std::size_t kPositionBytes = 512;
constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kRanges = 32;   // per block
constexpr double kRangeUnit = 0.002;  // m
constexpr unsigned kDualReturn = 0x39;
constexpr unsigned kHdl32 = 0x21;
constexpr unsigned kVlp16 = 0x22;

/// How a model fires: `lasers` one after the other, all of them every `cycle`.
struct Model {
  std::size_t lasers = 0;
  double cycle = 0.0;                  ///< s
  double step = 0.0;                   ///< s between two lasers
  std::array<double, 32> elevation{};  ///< degrees, in the order of firing
  std::array<double, 32> height{};     ///< m, of a laser over the sensor's centre
};

constexpr Model kVlp16Model = {
    .lasers = 16,
    .cycle = 55.296e-6,
    .step = 2.304e-6,
    .elevation = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15},
    .height = {0.0112, -0.0007, 0.0097, -0.0022, 0.0081, -0.0037, 0.0066, -0.0051, 0.0051, -0.0066,
               0.0037, -0.0081, 0.0022, -0.0097, 0.0007, -0.0112}};
constexpr Model kHdl32Model = {
    .lasers = 32,
    .cycle = 46.08e-6,
    .step = 1.152e-6,
    .elevation = {-30.67, -9.33, -29.33, -8.00, -28.00, -6.67, -26.67, -5.33,
                  -25.33, -4.00, -24.00, -2.67, -22.67, -1.33, -21.33, 0.00,
                  -20.00, 1.33,  -18.67, 2.67,  -17.33, 4.00,  -16.00, 5.33,
                  -14.67, 6.67,  -13.33, 8.00,  -12.00, 9.33,  -10.67, 10.67},
    .height = {}};

unsigned byte(std::span<const std::byte> from, std::size_t at) {
  return std::to_integer<unsigned>(from[at]);
}
unsigned u16(std::span<const std::byte> from, std::size_t at) {
  return byte(from, at) | (byte(from, at + 1) << 8U);
}
uint32_t u32(std::span<const std::byte> from, std::size_t at) {
  return u16(from, at) | (u16(from, at + 2) << 16U);
}

const Model* model_of(std::span<const std::byte> data) {
  switch (byte(data, kDataBytes - 1)) {
    case kVlp16:
      return &kVlp16Model;
    case kHdl32:
      return &kHdl32Model;
    default:
      return nullptr;
  }
}

/// The rank of each laser from the lowest up.
std::array<uint16_t, 32> rings_of(const Model& model) {
  std::array<uint16_t, 32> rings{};
  for (std::size_t i = 0; i < model.lasers; ++i) {
    for (std::size_t k = 0; k < model.lasers; ++k) {
      rings[i] =
          static_cast<uint16_t>(rings[i] + (model.elevation[k] < model.elevation[i] ? 1 : 0));
    }
  }
  return rings;
}

/// Microseconds of the hour, in the hour that is nearest to the capture's clock.
Nanoseconds time_of(uint32_t microseconds, Nanoseconds received) {
  constexpr Nanoseconds kHour = std::chrono::hours(1);
  Nanoseconds time = received - received % kHour + std::chrono::microseconds(microseconds);
  if (time - received > kHour / 2) {
    time -= kHour;
  } else if (received - time > kHour / 2) {
    time += kHour;
  }
  return time;
}

double azimuth_of(std::span<const std::byte> data, std::size_t block) {
  return 0.01 * u16(data, kBlockBytes * block + 2);
}

/// "4807.038" as degrees: the last two digits before the point begin the minutes.
std::optional<double> degrees_of(std::string_view text, bool negative) {
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size() ||
      !(value >= 0.0 && value <= 18000.0)) {
    return std::nullopt;
  }
  const double whole = std::floor(value / 100.0);
  const double degrees = whole + (value - 100.0 * whole) / 60.0;
  return negative ? -degrees : degrees;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t comma = text.find(',');
    parts.push_back(text.substr(0, comma));
    if (comma == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(comma + 1);
  }
}

/// The words of the sentence between '$' and '*', where its checksum is right.
std::vector<std::string_view> sentence(std::string_view text) {
  const std::size_t begin = text.find("$GPRMC");
  const std::size_t star = begin == std::string_view::npos ? begin : text.find('*', begin);
  if (star == std::string_view::npos || star + 3 > text.size()) {
    return {};
  }
  const std::string_view body = text.substr(begin + 1, star - begin - 1);
  unsigned sum = 0;
  for (const char c : body) {
    sum ^= static_cast<unsigned char>(c);
  }
  unsigned told = 0;
  const auto end = std::from_chars(text.data() + star + 1, text.data() + star + 3, told, 16);
  if (end.ptr != text.data() + star + 3 || told != sum) {
    return {};
  }
  return split(body);
}

/// Two digits; -1 where they are none.
int two_digits(std::string_view text, std::size_t at) {
  int value = -1;
  if (at + 2 <= text.size()) {
    std::from_chars(text.data() + at, text.data() + at + 2, value);
  }
  return value;
}

/// The sentence's date and time of day, UTC, to the second.
std::optional<Nanoseconds> utc_of(std::string_view time, std::string_view date) {
  using namespace std::chrono;
  const int h = two_digits(time, 0);
  const int m = two_digits(time, 2);
  const int s = two_digits(time, 4);
  const year_month_day day{year(2000 + two_digits(date, 4)),
                           month(static_cast<unsigned>(two_digits(date, 2))),
                           std::chrono::day(static_cast<unsigned>(two_digits(date, 0)))};
  if (h < 0 || h > 23 || m < 0 || m > 59 || s < 0 || s > 60 || two_digits(date, 4) < 0 ||
      !day.ok()) {
    return std::nullopt;
  }
  return sys_days(day).time_since_epoch() + hours(h) + minutes(m) + std::chrono::seconds(s);
}

}  // namespace

bool is_velodyne_data(const Datagram& datagram) {
  return datagram.payload.size() == kDataBytes && u16(datagram.payload, 0) == 0xeeff;
}

bool is_velodyne_position(const Datagram& datagram) {
  constexpr uint16_t kPort = 8308;
  return datagram.payload.size() == kPositionBytes && datagram.port == kPort;
}

std::optional<std::string> velodyne_model(const Datagram& data) {
  switch (byte(data.payload, kDataBytes - 1)) {
    case kVlp16:
      return "VLP-16";
    case kHdl32:
      return "HDL-32E";
    default:
      return std::nullopt;
  }
}

bool VelodyneSweeps::begins_anew(double azimuth, Nanoseconds time) const {
  const Nanoseconds since = time - sweep_->stamp;
  return azimuth + 180.0 < last_azimuth_ || since < Nanoseconds(0) || since > kLongestSweep;
}

void VelodyneSweeps::add_block(const Datagram& datagram, std::size_t block,
                               Nanoseconds packet_time) {
  const std::span<const std::byte> data = datagram.payload;
  const Model& model = *model_of(data);
  static const std::array<uint16_t, 32> kVlp16Rings = rings_of(kVlp16Model);
  static const std::array<uint16_t, 32> kHdl32Rings = rings_of(kHdl32Model);
  const auto& rings = model.lasers == 16 ? kVlp16Rings : kHdl32Rings;
  const bool dual = byte(data, kDataBytes - 2) == kDualReturn;
  const std::size_t firing = dual ? block / 2 : block;
  const double block_time = model.cycle * static_cast<double>(kRanges / model.lasers);
  const double azimuth = azimuth_of(data, block);
  const double since_stamp =
      seconds(packet_time - sweep_->stamp) + block_time * static_cast<double>(firing);
  const std::span<const std::byte> ranges = data.subspan(kBlockBytes * block + 4, 3 * kRanges);
  const std::span<const std::byte> other =
      dual && block % 2 == 1 ? data.subspan(kBlockBytes * (block - 1) + 4, 3 * kRanges)
                             : std::span<const std::byte>{};
  for (std::size_t i = 0; i < kRanges; ++i) {
    const unsigned range = u16(ranges, 3 * i);
    const bool same = !other.empty() && u16(other, 3 * i) == range;
    if (range == 0 || same) {
      continue;
    }
    const std::size_t laser = i % model.lasers;
    const double within = model.cycle * static_cast<double>(i / model.lasers) +
                          model.step * static_cast<double>(laser);
    const double angle = (azimuth + advance_ * within / block_time) * kDegree;
    const double elevation = model.elevation[laser] * kDegree;
    const double metres = kRangeUnit * range;
    const double flat = metres * std::cos(elevation);
    sweep_->points.push_back(
        {static_cast<float>(flat * std::cos(angle)), static_cast<float>(-flat * std::sin(angle)),
         static_cast<float>(metres * std::sin(elevation) + model.height[laser]),
         static_cast<float>(byte(ranges, 3 * i + 2))});
    sweep_->times.push_back(static_cast<float>(std::max(0.0, since_stamp + within)));
    sweep_->rings.push_back(rings[laser]);
  }
}

std::vector<Sweep> VelodyneSweeps::take(const Datagram& datagram) {
  std::vector<Sweep> whole;
  const std::span<const std::byte> data = datagram.payload;
  const Model* model = model_of(data);
  if (model == nullptr) {
    return whole;
  }
  const bool dual = byte(data, kDataBytes - 2) == kDualReturn;
  const std::size_t step = dual ? 2 : 1;
  const double block_time = model->cycle * static_cast<double>(kRanges / model->lasers);
  const Nanoseconds packet_time = time_of(u32(data, kDataBytes - 6), datagram.received);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const double azimuth = azimuth_of(data, block);
    if (u16(data, kBlockBytes * block) != 0xeeff || azimuth >= 360.0) {
      continue;  // not written, or damaged
    }
    const Nanoseconds time =
        packet_time + nanoseconds(block_time * static_cast<double>(block / step));
    if (sweep_ && begins_anew(azimuth, time)) {
      whole.push_back(std::move(*sweep_));
      sweep_.reset();
    }
    if (!sweep_) {
      sweep_.emplace();
      sweep_->stamp = time;
    }
    last_azimuth_ = azimuth;
    if (block + step < kBlocks) {
      const double advance = std::fmod(azimuth_of(data, block + step) - azimuth + 360.0, 360.0);
      constexpr double kMostAdvance = 3.0;  // degrees; at 20 Hz it is 0.8
      advance_ = advance < kMostAdvance ? advance : advance_;
    }
    if (points_) {
      add_block(datagram, block, packet_time);
    }
  }
  return whole;
}

std::optional<Sweep> VelodyneSweeps::finish() {
  return std::exchange(sweep_, std::nullopt);
}

std::optional<GnssFix> velodyne_fix(const Datagram& position) {
  constexpr std::size_t kSentence = 206;
  const std::string_view text(reinterpret_cast<const char*>(position.payload.data()) + kSentence,
                              position.payload.size() - kSentence);
  // GPRMC, time, status, latitude, N/S, longitude, E/W, speed, course, date
  const std::vector<std::string_view> words = sentence(text);
  if (words.size() < 10 || words[2] != "A") {
    return std::nullopt;
  }
  const auto latitude = degrees_of(words[3], words[4] == "S");
  const auto longitude = degrees_of(words[5], words[6] == "W");
  const auto stamp = utc_of(words[1], words[9]);
  if (!latitude || !longitude || !stamp || std::abs(*latitude) > 90.0) {
    return std::nullopt;
  }
  return GnssFix{.stamp = *stamp,
                 .kind = GnssFixKind::single,
                 .latitude = *latitude,
                 .longitude = *longitude,
                 .altitude = 0.0,
                 .covariance = std::nullopt};
}

}  // namespace adit
