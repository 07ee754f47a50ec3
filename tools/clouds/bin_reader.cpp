// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/bin_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the numbers are read as they lie in the file");

constexpr uint32_t kFewestFloats = 3;
constexpr uint32_t kMostFloats = 8;
constexpr uint32_t kKitti = 4;
// A multiple of 3 to 8, so that each place of a point is sampled as often as the others.
constexpr std::size_t kBlock = 840;
constexpr std::size_t kSampledNumbers = 73 * kBlock;

/// A class of numbers: zero, not finite, or by sign, magnitude and whether it is whole.
std::size_t class_of(float value) {
  constexpr int kLeast = -12;  // powers of two
  constexpr int kGreatest = 20;
  if (!std::isfinite(value)) {
    return 0;
  }
  if (value == 0.0F) {
    return 1;
  }
  const int power = std::clamp(std::ilogb(value), kLeast, kGreatest) - kLeast;
  return 2 + 4 * static_cast<std::size_t>(power) + (value < 0.0F ? 2U : 0U) +
         (value == std::trunc(value) ? 1U : 0U);
}
constexpr std::size_t kClasses = 2 + 4 * 33;

/// Mutual information of a number's place in its point and its class, nats, less what chance gives
/// (Miller and Madow).
double information(std::span<const std::size_t> classes, std::size_t places) {
  const std::size_t count = classes.size() / places * places;
  if (count == 0) {
    return 0.0;
  }
  std::vector<double> joint(places * kClasses);
  std::vector<double> all(kClasses);
  for (std::size_t i = 0; i < count; ++i) {
    joint[i % places * kClasses + classes[i]] += 1.0;
    all[classes[i]] += 1.0;
  }
  const auto total = static_cast<double>(count);
  double sum = 0.0;
  for (std::size_t place = 0; place < places; ++place) {
    for (std::size_t k = 0; k < kClasses; ++k) {
      const double n = joint[place * kClasses + k];
      sum += n > 0.0 ? n / total * std::log(n * static_cast<double>(places) / all[k]) : 0.0;
    }
  }
  const auto used =
      static_cast<double>(std::ranges::count_if(all, [](double n) { return n > 0.0; }));
  return sum - (static_cast<double>(places) - 1.0) * (used - 1.0) / (2.0 * total);
}

std::vector<float> read_numbers(const std::filesystem::path& file, std::size_t most) {
  InputFile input(file);
  std::vector<float> numbers(std::min(input.size() / sizeof(float), most));
  input.read(numbers.data(), numbers.size() * sizeof(float));
  return numbers;
}

/// What a column beyond the intensity is; none where it is neither a ring nor a time.
std::optional<FieldRole> role_of(std::span<const float> numbers, std::size_t places,
                                 std::size_t place) {
  bool whole = true;
  bool rising = true;
  float least = numbers[place];
  float greatest = least;
  for (std::size_t i = place; i < numbers.size(); i += places) {
    const float value = numbers[i];
    whole = whole && value >= 0.0F && value <= 255.0F && value == std::trunc(value);
    rising = rising && std::isfinite(value) && value >= greatest;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  if (!(greatest > least)) {
    return std::nullopt;
  }
  const float span = greatest - least;
  const bool relative = std::abs(least) <= 0.1F * span || std::abs(greatest) <= 0.1F * span;
  if (rising && relative) {
    return FieldRole::time;
  }
  return whole ? std::optional(FieldRole::ring) : std::nullopt;
}

/// Where the roles lie in a point; -1: nowhere.
FieldRoles roles_of(std::span<const float> numbers, uint32_t places) {
  FieldRoles roles;
  const auto at = [&](FieldRole role) -> int& {
    return roles.index[static_cast<std::size_t>(role)];
  };
  at(FieldRole::x) = 0;
  at(FieldRole::y) = 1;
  at(FieldRole::z) = 2;
  if (places > 3) {
    at(FieldRole::intensity) = 3;
  }
  for (uint32_t place = kKitti; place < places && numbers.size() >= places; ++place) {
    const std::optional<FieldRole> role = role_of(numbers, places, place);
    if (role && at(*role) < 0) {
      at(*role) = static_cast<int>(place);
    }
  }
  return roles;
}

/// The floats of a point, as far as the file shows it.
std::optional<uint32_t> floats_of(std::span<const float> numbers, const CloudReading& reading) {
  return reading.floats_per_point
             ? reading.floats_per_point
             : find_floats_per_point(numbers.first(std::min(numbers.size(), kSampledNumbers)));
}

/// Throws InputError for a file that is no whole number of KITTI's points.
void require_kitti(const std::filesystem::path& file, std::size_t bytes) {
  const std::size_t points = bytes / sizeof(Point);
  const std::size_t surplus = bytes % sizeof(Point);
  if (surplus != 0) {
    throw InputError(
        file, Place::byte(points * sizeof(Point)),
        "the file has " + std::to_string(bytes) +
            " bytes, no multiple of 16 (x y z intensity as float32): " + std::to_string(surplus) +
            " are left over after " + std::to_string(points) +
            " points, and its numbers do not show how many a point has",
        "If the file is whole, set recording.floats_per_point; else copy it again");
  }
}

}  // namespace

std::optional<uint32_t> find_floats_per_point(std::span<const float> numbers) {
  constexpr std::size_t kLeast = 100;  // numbers; fewer show nothing
  constexpr double kClear = 0.25;      // nats; clouds have 0.3 to 1.5, other places below 0.05
  constexpr double kAsMuch = 0.85;  // of the greatest: multiples of the right number have as much
  if (numbers.size() < kLeast) {
    return std::nullopt;
  }
  std::vector<std::size_t> classes(numbers.size());
  std::ranges::transform(numbers, classes.begin(), class_of);
  std::array<double, kMostFloats + 1> mutual_information{};
  for (uint32_t places = kFewestFloats; places <= kMostFloats; ++places) {
    mutual_information[places] = information(classes, places);
  }
  const double greatest = *std::ranges::max_element(mutual_information);
  if (greatest < kClear) {
    return std::nullopt;
  }
  for (uint32_t places = kFewestFloats; places <= kMostFloats; ++places) {
    if (mutual_information[places] >= kAsMuch * greatest) {
      return places;
    }
  }
  return std::nullopt;
}

CloudFile read_bin(const std::filesystem::path& file, const CloudReading& reading) {
  return parse_bin(file, read_whole_file(file), reading);
}

CloudFile parse_bin(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading) {
  const std::size_t bytes = content.size();
  std::vector<float> numbers(bytes / sizeof(float));
  if (!numbers.empty()) {
    std::memcpy(numbers.data(), content.data(), numbers.size() * sizeof(float));
  }
  const std::optional<uint32_t> known = floats_of(numbers, reading);
  if (!known) {
    require_kitti(file, bytes);
  }
  const uint32_t places = known.value_or(kKitti);
  const std::size_t point_bytes = places * sizeof(float);
  const std::size_t points = bytes / point_bytes;
  const FieldRoles roles = roles_of(std::span(numbers).first(points * places), places);
  CloudColumns columns;
  columns.points = points;
  columns.time_field = "time";
  columns.reading = reading;
  columns.reading.coordinate_scale.reset();
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
    if (roles.index[role] >= 0) {
      columns.columns[role] =
          Column{.data = reinterpret_cast<const std::byte*>(numbers.data()),
                 .offset = static_cast<std::size_t>(roles.index[role]) * sizeof(float),
                 .stride = point_bytes,
                 .type = ScalarType::f32};
    }
  }
  CloudFile cloud = decode_cloud(file, columns);
  cloud.floats_per_point = known;
  if (const std::size_t surplus = bytes % point_bytes; surplus != 0) {
    InputError fault(file, Place::byte(points * point_bytes),
                     "the file has " + std::to_string(bytes) + " bytes, no multiple of " +
                         std::to_string(point_bytes) + " (" + std::to_string(places) +
                         " float32 a point): " + std::to_string(surplus) + " are left over after " +
                         std::to_string(points) + " points",
                     "The file is cut off: copy it again, or set recording.floats_per_point");
    if (points == 0) {
      throw fault;
    }
    cloud.faults.push_back(fault);
  }
  return cloud;
}

std::string describe_bin(const std::filesystem::path& file) {
  try {
    const std::vector<float> numbers = read_numbers(file, kSampledNumbers);
    const uint32_t places = find_floats_per_point(numbers).value_or(kKitti);
    if (places == kKitti) {
      return {};
    }
    const FieldRoles roles = roles_of(numbers, places);
    std::string names = "x y z";
    for (int place = 3; place < static_cast<int>(places); ++place) {
      names += roles[FieldRole::intensity] == place ? " intensity"
               : roles[FieldRole::ring] == place    ? " ring"
               : roles[FieldRole::time] == place    ? " time"
                                                    : " ?";
    }
    return "by its numbers a point has " + std::to_string(places) + " floats (" + names + ")";
  } catch (const InputError&) {
    return {};  // reported where the sweeps are read
  }
}

}  // namespace adit
