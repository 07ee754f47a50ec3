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
#include "adit/tools/packets/velodyne_models.hpp"

namespace adit {
namespace {

constexpr std::size_t kDataBytes = 1206;
constexpr std::size_t kPositionBytes = 512;
constexpr std::size_t kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kRanges = 32;  // per block
constexpr unsigned kDualReturn = 0x39;

unsigned byte(std::span<const std::byte> from, std::size_t at) {
  return std::to_integer<unsigned>(from[at]);
}
unsigned u16(std::span<const std::byte> from, std::size_t at) {
  return byte(from, at) | (byte(from, at + 1) << 8U);
}
uint32_t u32(std::span<const std::byte> from, std::size_t at) {
  return u16(from, at) | (u16(from, at + 2) << 16U);
}

const VelodyneModel* model_of(std::span<const std::byte> data) {
  return find_velodyne_model(byte(data, kDataBytes - 1));
}

/// Returns of a firing, a block of ranges each.
std::size_t returns_of(std::span<const std::byte> data) {
  return byte(data, kDataBytes - 2) == kDualReturn ? 2 : 1;
}

/// Blocks from one whose lasers fire at an azimuth to the one whose same lasers fire at the next.
std::size_t stride_of(const VelodyneModel& model, std::size_t returns) {
  return returns * std::max<std::size_t>(1, model.lasers / kRanges);
}

/// s from a block to the one that is a stride after it.
double stride_time(const VelodyneModel& model) {
  return model.cycle * static_cast<double>(std::max<std::size_t>(1, kRanges / model.lasers));
}

/// The first laser of a block by its flag: four blocks hold the lasers of a VLS-128. Nothing for a
/// block that was not written, or is damaged.
std::optional<std::size_t> first_laser(std::span<const std::byte> data, std::size_t block,
                                       const VelodyneModel& model) {
  constexpr std::array<unsigned, 4> kFlags = {0xeeff, 0xddff, 0xccff, 0xbbff};
  const unsigned flag = u16(data, kBlockBytes * block);
  for (std::size_t bank = 0; bank * kRanges < model.lasers; ++bank) {
    if (flag == kFlags.at(bank)) {
      return bank * kRanges;
    }
  }
  return std::nullopt;
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
  return datagram.payload.size() == kDataBytes && datagram.missing == 0 &&
         u16(datagram.payload, 0) == 0xeeff;
}

bool is_velodyne_position(const Datagram& datagram) {
  constexpr uint16_t kPort = 8308;
  return datagram.payload.size() == kPositionBytes && datagram.missing == 0 &&
         datagram.port == kPort;
}

std::optional<std::string> velodyne_model(const Datagram& data) {
  const VelodyneModel* model = model_of(data.payload);
  return model != nullptr ? std::optional(std::string(model->name)) : std::nullopt;
}

Nanoseconds velodyne_time(const Datagram& data) {
  return time_of(u32(data.payload, kDataBytes - 6), data.received);
}

bool VelodyneSweeps::begins_anew(double azimuth, Nanoseconds time) const {
  const Nanoseconds since = time - sweep_->stamp;
  return azimuth + 180.0 < last_azimuth_ || since < Nanoseconds(0) || since > kLongestTurn;
}

/// Degrees from the block to the one a stride after it; where the packet has none, those from the
/// sequence before it to this one. Those of the last that made sense stand in for others.
void VelodyneSweeps::follow_rotation(std::span<const std::byte> data, std::size_t block,
                                     const VelodyneModel& model, Nanoseconds time) {
  constexpr double kMostAdvance = 3.0;  // degrees; at 20 Hz it is 0.8
  const std::size_t stride = stride_of(model, returns_of(data));
  const double azimuth = azimuth_of(data, block);
  double advance = kMostAdvance;
  if (block + stride < kBlocks && first_laser(data, block + stride, model)) {
    advance = std::fmod(azimuth_of(data, block + stride) - azimuth + 360.0, 360.0);
  } else if (block == 0 && last_time_ && seconds(time - *last_time_) < 1.5 * stride_time(model)) {
    advance = std::fmod(azimuth - last_azimuth_ + 360.0, 360.0);
  }
  advance_ = advance < kMostAdvance ? advance : advance_;
}

void VelodyneSweeps::add_block(std::span<const std::byte> data, std::size_t block,
                               const VelodyneModel& model, double since_stamp) {
  const std::size_t returns = returns_of(data);
  const std::size_t first = first_laser(data, block, model).value_or(0);
  const double azimuth = azimuth_of(data, block);
  const std::span<const std::byte> ranges = data.subspan(kBlockBytes * block + 4, 3 * kRanges);
  const std::span<const std::byte> other =
      returns == 2 && block % 2 == 1 ? data.subspan(kBlockBytes * (block - 1) + 4, 3 * kRanges)
                                     : std::span<const std::byte>{};
  for (std::size_t i = 0; i < kRanges; ++i) {
    const unsigned range = u16(ranges, 3 * i);
    const bool same = !other.empty() && u16(other, 3 * i) == range;
    if (range == 0 || same) {
      continue;
    }
    const std::size_t laser = (first + i) % model.lasers;
    const double within = model.cycle * static_cast<double>(i / model.lasers) + model.firing[laser];
    const double angle =
        (azimuth + model.azimuth[laser] + advance_ * within / stride_time(model)) * kDegree;
    const double elevation = model.elevation[laser] * kDegree;
    const double metres = model.range_unit * range;
    const double flat = metres * std::cos(elevation);
    sweep_->points.push_back(
        {static_cast<float>(flat * std::cos(angle)), static_cast<float>(-flat * std::sin(angle)),
         static_cast<float>(metres * std::sin(elevation) + model.height[laser]),
         static_cast<float>(byte(ranges, 3 * i + 2))});
    sweep_->times.push_back(static_cast<float>(std::max(0.0, since_stamp + within)));
    sweep_->rings.push_back(model.rings[laser]);
  }
}

std::vector<Sweep> VelodyneSweeps::take(const Datagram& datagram) {
  std::vector<Sweep> whole;
  const std::span<const std::byte> data = datagram.payload;
  const VelodyneModel* model = model_of(data);
  if (model == nullptr) {
    return whole;
  }
  const std::size_t stride = stride_of(*model, returns_of(data));
  const Nanoseconds packet_time = velodyne_time(datagram) + nanoseconds(model->first_firing);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const double azimuth = azimuth_of(data, block);
    if (!first_laser(data, block, *model) || azimuth >= 360.0) {
      continue;  // not written, or damaged
    }
    const double after = stride_time(*model) * static_cast<double>(block / stride);
    const Nanoseconds time = packet_time + nanoseconds(after);
    if (sweep_ && begins_anew(azimuth, time)) {
      whole.push_back(std::move(*sweep_));
      sweep_.reset();
    }
    if (!sweep_) {
      sweep_.emplace();
      sweep_->stamp = time;
    }
    follow_rotation(data, block, *model, time);
    last_azimuth_ = azimuth;
    last_time_ = time;
    if (points_) {
      add_block(data, block, *model, seconds(packet_time - sweep_->stamp) + after);
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
