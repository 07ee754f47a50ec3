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
  std::vector<std::string> options{};  ///< the options of `adit export` that write it
  std::string about{};                 ///< a sentence for whoever gets it
  bool needs_place = false;            ///< a map without a place on the Earth has none
  bool needs_recording = false;        ///< made of the recording that the map is of
  bool needs_cameras = false;          ///< that recording has cameras whose place is known
  bool optional = false;               ///< left out where the map has nothing for it
};

/// The text of the preset that is used where none is named, TOML.
std::string_view default_delivery();
/// The products of a preset. Throws InputError: no TOML, an unknown key, a name that is no plain
/// file name or stands twice.
std::vector<DeliveryProduct> parse_delivery(std::string_view text,
                                            const std::filesystem::path& file);

/// Where points are, for all products alike.
struct DeliveryPlace {
  bool on_earth = false;                ///< the map, or `origin`, has a place on the Earth
  std::optional<std::string> origin{};  ///< "LAT,LON,ALT[,YAW]"
  std::optional<std::string> crs{};     ///< "EPSG:25830"
  std::optional<std::filesystem::path> geoid{};
  std::optional<std::filesystem::path> recording{};
  std::optional<std::filesystem::path> calibration{};  ///< a file of cameras
};

/// By --colorize, or as an orthophoto.
bool wants_colors(const DeliveryProduct& product);
/// The same without --colorize.
DeliveryProduct without_colors(DeliveryProduct product);
/// Why the map's points can have no colours: its recording is not there, or has no cameras whose
/// calibration and place are known. Empty where they can. `folder`: that files are written to.
std::string why_no_colors(const MapDatabase& map, const DeliveryPlace& place,
                          const std::filesystem::path& folder);

/// The words of `adit export` for a product: those of the preset, and of the place as far as the
/// product takes them. Points of a map on the Earth are in one system in all files.
std::vector<std::string> export_words(const DeliveryProduct& product, const DeliveryPlace& place);

/// What all products' points are in, by name; empty: the map's own frame. Throws UsageError where
/// the place is none.
std::string delivery_system(const MapDatabase& map, const DeliveryPlace& place);

/// What the page says of a product's coordinates. `system`: that of the points; empty: the map has
/// no place.
std::string coordinates_of_product(const DeliveryProduct& product, const std::string& system);

/// The files of a product in a folder: its own, numbered ones (plan_0.dxf), and those beside it
/// (grid.pgm).
std::vector<std::filesystem::path> files_of_product(const DeliveryProduct& product,
                                                    const std::filesystem::path& folder);

/// What is in a folder already, by the folder's delivery.json. A product is made again where the
/// map, another input, its words or adit's version is another.
class DeliveryRecord {
 public:
  /// Empty where the file is not there or holds something else. Throws InputError where it cannot
  /// be read.
  explicit DeliveryRecord(std::filesystem::path folder);

  /// Whether the folder has such a file.
  static bool is_in(const std::filesystem::path& folder);

  bool has(const DeliveryProduct& product, const std::string& state) const;
  /// Keeps it on disk, too. Throws OutputError.
  void add(const DeliveryProduct& product, const std::string& state);
  /// Removes a product that was made of something else, with its files.
  void remove(const DeliveryProduct& product);

 private:
  void keep() const;

  std::filesystem::path folder_;
  std::map<std::string, std::string> made_{};  ///< state by file
};

/// What a product is made of: the contents of all inputs, the words, and adit's version.
std::string delivery_state(const std::vector<std::filesystem::path>& inputs,
                           const std::vector<std::string>& words);

/// The page, Markdown: dates, and each file with its coordinates and what it is for.
std::string delivery_page(const MapDatabase& map, const std::string& system,
                          const std::vector<DeliveryProduct>& products,
                          const std::filesystem::path& folder);

}  // namespace adit
