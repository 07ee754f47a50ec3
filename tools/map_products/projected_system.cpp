// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/projected_system.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include <dlfcn.h>
#include <fmt/core.h>
#include <proj.h>

namespace adit {
namespace {

constexpr double kAreaMargin = 3.0;     // degrees beyond its area of use that a system still serves
constexpr double kFar = 1e-5;           // degrees, from where a place comes back to: not covered
constexpr double kSamePosition = 1e-3;  // m

constexpr const char* kNotInstalled =
    "coordinate reference systems by name need PROJ, which is not installed (Debian: apt install "
    "libproj25). Without it there are --frame utm and local";

std::string text_of(const char* text) {
  return text == nullptr ? std::string() : std::string(text);
}

}  // namespace

/// PROJ as it is on this machine, of the major version that this was compiled for. Never unloaded.
class ProjLibrary {
 public:
  ProjLibrary() {
    // The file's name has a number that grows with releases whose calls stay the same.
    constexpr std::array kFiles = {"libproj.so.25", "libproj.so.22", "libproj.so.19", "libproj.so"};
    for (const char* file : kFiles) {
      library_ = library_ == nullptr ? dlopen(file, RTLD_NOW | RTLD_LOCAL) : library_;
    }
    if (library_ == nullptr) {
      throw NoSuchSystem(kNotInstalled);
    }
  }

  template <class Function>
  Function* call(const char* name) const {
    void* const found = dlsym(library_, name);
    if (found == nullptr) {
      throw NoSuchSystem(fmt::format("the PROJ that is installed lacks {}; it is too old", name));
    }
    Function* function = nullptr;
    std::memcpy(&function, &found, sizeof(function));
    return function;
  }

 private:
  void* library_ = nullptr;
};

/// The calls that are used, typed as its header has them.
struct ProjCalls {
  explicit ProjCalls(const ProjLibrary& proj)
      : context_create(proj.call<decltype(proj_context_create)>("proj_context_create")),
        context_destroy(proj.call<decltype(proj_context_destroy)>("proj_context_destroy")),
        log_level(proj.call<decltype(proj_log_level)>("proj_log_level")),
        create(proj.call<decltype(proj_create)>("proj_create")),
        destroy(proj.call<decltype(proj_destroy)>("proj_destroy")),
        get_type(proj.call<decltype(proj_get_type)>("proj_get_type")),
        get_name(proj.call<decltype(proj_get_name)>("proj_get_name")),
        get_id_auth_name(proj.call<decltype(proj_get_id_auth_name)>("proj_get_id_auth_name")),
        get_id_code(proj.call<decltype(proj_get_id_code)>("proj_get_id_code")),
        as_wkt(proj.call<decltype(proj_as_wkt)>("proj_as_wkt")),
        get_coordinate_system(
            proj.call<decltype(proj_crs_get_coordinate_system)>("proj_crs_get_coordinate_system")),
        get_axis_info(proj.call<decltype(proj_cs_get_axis_info)>("proj_cs_get_axis_info")),
        create_crs_to_crs(
            proj.call<decltype(proj_create_crs_to_crs_from_pj)>("proj_create_crs_to_crs_from_pj")),
        normalize(proj.call<decltype(proj_normalize_for_visualization)>(
            "proj_normalize_for_visualization")),
        trans(proj.call<decltype(proj_trans)>("proj_trans")),
        area_of_use(proj.call<decltype(proj_get_area_of_use)>("proj_get_area_of_use")) {}

  decltype(&proj_context_create) context_create;
  decltype(&proj_context_destroy) context_destroy;
  decltype(&proj_log_level) log_level;
  decltype(&proj_create) create;
  decltype(&proj_destroy) destroy;
  decltype(&proj_get_type) get_type;
  decltype(&proj_get_name) get_name;
  decltype(&proj_get_id_auth_name) get_id_auth_name;
  decltype(&proj_get_id_code) get_id_code;
  decltype(&proj_as_wkt) as_wkt;
  decltype(&proj_crs_get_coordinate_system) get_coordinate_system;
  decltype(&proj_cs_get_axis_info) get_axis_info;
  decltype(&proj_create_crs_to_crs_from_pj) create_crs_to_crs;
  decltype(&proj_normalize_for_visualization) normalize;
  decltype(&proj_trans) trans;
  decltype(&proj_get_area_of_use) area_of_use;
};

struct ProjectedSystem::State {
  explicit State(const std::string& definition)
      : calls(ProjLibrary()), context(calls.context_create(), calls.context_destroy) {
    calls.log_level(context.get(), PJ_LOG_NONE);
    const Handle system = made(calls.create(context.get(), definition.c_str()));
    const Handle earth = made(calls.create(context.get(), "EPSG:4979"));
    if (!earth) {
      throw NoSuchSystem(
          "PROJ does not find its database, proj.db (Debian: apt install proj-data; the "
          "environment's PROJ_DATA or PROJ_LIB may name a folder without it)");
    }
    if (!system) {
      throw NoSuchSystem("PROJ knows no coordinate reference system '" + definition +
                         "'. EPSG:25830 would be one");
    }
    name = text_of(calls.get_name(system.get()));
    require_metres(system, definition);
    wkt = text_of(calls.as_wkt(context.get(), system.get(), PJ_WKT1_GDAL, options().data()));
    if (wkt.empty()) {
      throw NoSuchSystem("'" + name +
                         "' cannot be written as OGC WKT 1, which LAS and GeoTIFF need");
    }
    if (text_of(calls.get_id_auth_name(system.get(), 0)) == "EPSG") {
      const std::string code = text_of(calls.get_id_code(system.get(), 0));
      int number = 0;
      if (std::from_chars(code.data(), code.data() + code.size(), number).ec == std::errc()) {
        epsg = number;
      }
    }
    std::array<double, 4> edges{};
    if (calls.area_of_use(context.get(), system.get(), &edges[0], &edges[1], &edges[2], &edges[3],
                          nullptr) != 0 &&
        edges[0] >= -180.0) {
      area = edges;
    }
    const Handle forth =
        made(calls.create_crs_to_crs(context.get(), earth.get(), system.get(), nullptr, nullptr));
    to_system = forth ? made(calls.normalize(context.get(), forth.get())) : made(nullptr);
    if (!to_system) {
      throw NoSuchSystem("PROJ knows no way from WGS 84 to '" + name + "'");
    }
  }

  using Handle = std::unique_ptr<PJ, decltype(&proj_destroy)>;
  Handle made(PJ* object) const { return {object, calls.destroy}; }

  static std::array<const char*, 2> options() { return {"MULTILINE=NO", nullptr}; }

  /// Both axes in metres, of a system of the plane.
  void require_metres(const Handle& system, const std::string& definition) const {
    const std::string what =
        definition + (name.empty() || name == definition ? "" : " (" + name + ")");
    if (calls.get_type(system.get()) != PJ_TYPE_PROJECTED_CRS) {
      throw NoSuchSystem(what +
                         " is no projected system: products are in metres east and north. Degrees "
                         "are in trajectories as CSV, GeoJSON, KML and GeoPackage");
    }
    const Handle axes = made(calls.get_coordinate_system(context.get(), system.get()));
    for (const int axis : {0, 1}) {
      double factor = 0.0;
      const char* unit = nullptr;
      if (!axes ||
          calls.get_axis_info(context.get(), axes.get(), axis, nullptr, nullptr, nullptr, &factor,
                              &unit, nullptr, nullptr) == 0 ||
          factor != 1.0) {
        throw NoSuchSystem(what + " is in " + (unit == nullptr ? "another unit" : unit) +
                           "; products are in metres");
      }
    }
  }

  ProjCalls calls;
  std::unique_ptr<PJ_CONTEXT, decltype(&proj_context_destroy)> context;
  std::string name;
  std::string wkt;
  std::optional<int> epsg;
  Handle to_system{nullptr, nullptr};
  std::optional<std::array<double, 4>> area;  ///< west, south, east, north, degrees

  bool covers(const Geodetic& place) const {
    if (!area) {
      return true;
    }
    const auto& [west, south, east, north] = *area;
    // How far east of the western edge, within one turn: areas may lie across 180 degrees.
    const auto eastward = [from = west](double longitude) {
      return longitude - from - 360.0 * std::floor((longitude - from + kAreaMargin) / 360.0);
    };
    const double width = east < west ? east + 360.0 - west : east - west;
    return place.latitude >= south - kAreaMargin && place.latitude <= north + kAreaMargin &&
           eastward(place.longitude) <= width + kAreaMargin;
  }
};

ProjectedSystem::ProjectedSystem(const std::string& definition)
    : state_(std::make_shared<const State>(definition)) {}

const std::string& ProjectedSystem::name() const {
  return state_->name;
}

std::optional<int> ProjectedSystem::epsg() const {
  return state_->epsg;
}

const std::string& ProjectedSystem::wkt() const {
  return state_->wkt;
}

Eigen::Vector2d ProjectedSystem::position_of(const Geodetic& place) const {
  const ProjCalls& calls = state_->calls;
  PJ* const way = state_->to_system.get();
  const PJ_COORD asked = {{place.longitude, place.latitude, place.altitude, HUGE_VAL}};
  const PJ_COORD found = calls.trans(way, PJ_FWD, asked);
  const PJ_COORD back = calls.trans(way, PJ_INV, found);
  // Far from its area a projection gives numbers that lead somewhere else.
  const double off =
      std::hypot(std::remainder(back.v[0] - asked.v[0], 360.0), back.v[1] - asked.v[1]);
  if (!state_->covers(place) || !std::isfinite(found.v[0]) || !std::isfinite(found.v[1]) ||
      !(off < kFar)) {
    throw NoSuchSystem(fmt::format("'{}' does not cover {:.5f}, {:.5f} (latitude, longitude)",
                                   state_->name, place.latitude, place.longitude));
  }
  return {found.v[0], found.v[1]};
}

Geodetic ProjectedSystem::place_of(const Eigen::Vector2d& position, double altitude) const {
  const PJ_COORD asked = {{position.x(), position.y(), altitude, HUGE_VAL}};
  const PJ_COORD found = state_->calls.trans(state_->to_system.get(), PJ_INV, asked);
  const Geodetic place{.latitude = found.v[1], .longitude = found.v[0], .altitude = altitude};
  const bool is_place = std::isfinite(place.latitude) && std::isfinite(place.longitude);
  if (!is_place || !((position_of(place) - position).norm() < kSamePosition)) {
    throw NoSuchSystem(fmt::format("'{}' does not cover {:.3f} east, {:.3f} north", state_->name,
                                   position.x(), position.y()));
  }
  return place;
}

}  // namespace adit
