// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Where the lasers of a sensor point, in the order of its channels.
struct HesaiAngles {
  std::vector<double> elevations{};  ///< degrees, up
  std::vector<double> azimuths{};    ///< degrees, added to that of the block
};

/// When the blocks of a packet begin.
struct HesaiBlocks {
  double first = 0.0;      ///< s from the packet's time to the first block, or to the last one
  double period = 0.0;     ///< s from a block to the next
  bool from_last = false;  ///< `first` is that of the last block
};

/// Where and when the lasers of a model fire, after its manual.
struct HesaiModel {
  std::string name{};
  HesaiAngles design{};
  bool each_has_its_own = false;  ///< the angles of a sensor differ from those of the design
  HesaiBlocks blocks{};
  /// s after the begin of a block, when the rotor stood at its azimuth. Nothing: the azimuth is
  /// that of all lasers, whenever they fire.
  std::optional<double> azimuth_read{};
  /// s after the begin of a block, by channel; of each firing sequence where there are two.
  std::array<std::vector<double>, 2> firing{};
};

/// The model of that name ("PandarXT-32", "XT32M2X", "Pandar40P", "PandarQT64", "QT128C2X"); null
/// for others, whose angles differ from sensor to sensor, and of which adit knows times of blocks.
const HesaiModel* find_hesai_model(std::string_view name);

}  // namespace adit
