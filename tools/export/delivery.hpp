// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a client gets of a map: a folder of files, and a page that says what they are.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// A file of a delivery.
struct DeliveryProduct {
  std::string file{};                  ///< its name in the folder
  std::vector<std::string> options{};  ///< what `adit export` is told to write it
  std::string about{};                 ///< a sentence for whoever gets it
  bool needs_place = false;            ///< a map without a place on the Earth has none
  bool needs_recording = false;        ///< made of the recording that the map is of
};

/// The text of the preset that is used where none is named, TOML.
std::string_view default_delivery();
/// The products of a preset. Throws InputError: no TOML, an unknown key, a name that is no plain
/// file name or stands twice.
std::vector<DeliveryProduct> parse_delivery(std::string_view text,
                                            const std::filesystem::path& file);

/// Where points are, for all products alike.
struct DeliveryPlace {
  std::optional<std::string> origin{};  ///< "LAT,LON,ALT[,YAW]"
  std::optional<std::string> crs{};     ///< "EPSG:25830"
  std::optional<std::filesystem::path> geoid{};
  std::optional<std::filesystem::path> recording{};
};

/// The words of `adit export` for a product: those of the preset, and of the place as far as the
/// product has any use for them.
std::vector<std::string> export_words(const DeliveryProduct& product, const DeliveryPlace& place);

/// What is in a folder already: a product is made again where the map or its words are others.
class DeliveryRecord {
 public:
  /// Of the folder's delivery.json; nothing is in it where that is not there or cannot be read.
  explicit DeliveryRecord(std::filesystem::path folder);

  bool has(const std::string& file, const std::string& map,
           const std::vector<std::string>& words) const;
  /// Keeps it on disk, too. Throws OutputError.
  void add(const std::string& file, const std::string& map, const std::vector<std::string>& words);

 private:
  std::filesystem::path folder_;
  std::map<std::string, std::string> made_{};  ///< by file: the map and the words
};

/// The page, Markdown: coordinates, times, and each file with what it is for.
std::string delivery_page(const MapDatabase& map, const std::string& coordinates,
                          const std::vector<DeliveryProduct>& products,
                          const std::filesystem::path& folder);

}  // namespace adit
