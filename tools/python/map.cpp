// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/map.hpp"

#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/python/arrays.hpp"
#include "adit/tools/python/gil.hpp"
#include "adit/tools/python/measurements.hpp"
#include "adit/tools/python/pickling.hpp"
#include "adit/tools/python/trajectories.hpp"

namespace adit::python {
namespace {

/// A map that is read. One thread at a time is in its database.
class OpenMap {
 public:
  explicit OpenMap(const std::filesystem::path& file) : file_(file) {
    database_.emplace(file, MapAccess::read);
  }

  const std::filesystem::path& file() const { return file_; }
  /// Throws ValueError once it is closed.
  template <class Call>
  auto with(Call&& call) {
    return without_gil([&] {
      const std::lock_guard lock(mutex_);
      if (!database_) {
        throw py::value_error(file_.string() + ": the map is closed");
      }
      return call(std::as_const(*database_));
    });
  }
  /// Does not check for signals: an exception would leave the map open.
  void close() {
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    database_.reset();
  }

 private:
  std::filesystem::path file_;
  std::mutex mutex_;
  std::optional<MapDatabase> database_;
};

/// A submap with its points as arrays can have them.
struct Submap {
  NodeId keyframe = 0;
  double r_submap = 0.0;
  Vertical vertical = Vertical::unknown;
  std::vector<SubmapSweep> sweeps;
  std::vector<float> points{};
  std::vector<float> directions{};
  std::vector<uint8_t> seen_through{};
  std::vector<uint16_t> sweep_of{};
};

Submap read_submap(const MapDatabase& map, NodeId keyframe) {
  KeyframeSubmap stored = load_submap(map, keyframe, map.file());
  Submap submap{.keyframe = keyframe,
                .r_submap = stored.r_submap,
                .vertical = stored.vertical,
                .sweeps = std::move(stored.sweeps)};
  submap.points.reserve(3 * stored.points.size());
  for (const SubmapPoint& point : stored.points) {
    const Eigen::Vector3f position = point.position().cast<float>();
    const Eigen::Vector3f direction = is_plane(point.surface)
                                          ? surface_direction(point.surface).cast<float>().eval()
                                          : Eigen::Vector3f::Zero().eval();
    submap.points.insert(submap.points.end(), position.data(), position.data() + 3);
    submap.directions.insert(submap.directions.end(), direction.data(), direction.data() + 3);
    submap.seen_through.push_back(point.seen_through ? 1 : 0);
    submap.sweep_of.push_back(point.sweep);
  }
  return submap;
}

py::object rows(const std::vector<float>& numbers, const py::object& owner) {
  return view_of(numbers, owner).attr("reshape")(-1, 3);
}

void bind_records(py::module_& module) {
  py::class_<MapSession>(module, "MapSession", "One recording's share of a map.")
      .def_readonly("id", &MapSession::id)
      .def_readonly("name", &MapSession::name)
      .def_readonly("configuration", &MapSession::configuration,
                    "TOML, as `adit config` prints it.")
      .def_property_readonly(
          "provenance",
          [](const MapSession& self) {
            py::dict dict;
            for (const auto& [key, value] : self.provenance) {
              dict[py::str(key)] = value;
            }
            return dict;
          },
          "Where it comes from: recording, device, driver, version.")
      .def(pickling<MapSession>());
  py::class_<MapKeyframe>(module, "Keyframe", "A node of the graph with the sweep it belongs to.")
      .def_readonly("id", &MapKeyframe::id)
      .def_readonly("session", &MapKeyframe::session, "Whose it is.")
      .def_property_readonly(
          "stamp", [](const MapKeyframe& self) { return self.stamp.count(); }, "ns.")
      .def_property_readonly(
          "pose", [](const MapKeyframe& self) { return array_of(self.T_map_keyframe); },
          "(4, 4), T_map_keyframe, m.")
      .def_property_readonly(
          "covariance", [](const MapKeyframe& self) { return array_of(self.covariance); },
          "(6, 6), of pose: right perturbation [translation, rotation], m and rad.")
      .def_property_readonly(
          "vertical", [](const MapKeyframe& self) { return std::string(to_string(self.vertical)); },
          "What its submap knows the vertical from: gravity, ground or unknown.")
      .def(pickling<MapKeyframe>())
      .def("__repr__",
           [](const MapKeyframe& self) { return fmt::format("<adit.Keyframe {}>", self.id); });
  py::class_<PoseEdge>(module, "Edge", "A measured pose of one keyframe in another's frame.")
      .def_readonly("from_", &PoseEdge::from, "Id of a keyframe.")
      .def_readonly("to", &PoseEdge::to, "Id of a keyframe.")
      .def_property_readonly(
          "T_from_to", [](const PoseEdge& self) { return array_of(self.T_from_to); }, "(4, 4), m.")
      .def_property_readonly(
          "information", [](const PoseEdge& self) { return array_of(self.information); },
          "(6, 6), [translation, rotation]: 1/m^2, 1/(m rad), 1/rad^2.")
      .def_property_readonly(
          "kind", [](const PoseEdge& self) { return std::string(to_string(self.kind)); },
          "odometry, loop, or start: where a session was expected to begin, which does not count.")
      .def_property_readonly(
          "status", [](const PoseEdge& self) { return std::string(to_string(self.status)); },
          "active, candidate or revoked; only active ones count.")
      .def(pickling<PoseEdge>());
  py::class_<LoopCandidate>(module, "Loop", "A place that might have been seen before.")
      .def_readonly("id", &LoopCandidate::id)
      .def_readonly("from_", &LoopCandidate::from, "Id of a keyframe.")
      .def_readonly("to", &LoopCandidate::to, "Id of a keyframe.")
      .def_property_readonly(
          "T_from_to", [](const LoopCandidate& self) { return array_of(self.T_from_to); },
          "(4, 4), m.")
      .def_property_readonly(
          "verdict", [](const LoopCandidate& self) { return std::string(to_string(self.verdict)); },
          "waiting, accepted, rejected or revoked.")
      .def_property_readonly(
          "source", [](const LoopCandidate& self) { return std::string(to_string(self.source)); },
          "position or appearance: how it was found.")
      .def_readonly("reason", &LoopCandidate::reason, "Of the verdict, a word.")
      .def_readonly("overlap", &LoopCandidate::overlap, "Share of points with a match.")
      .def_readonly("rms", &LoopCandidate::rms, "Of the matches, m.")
      .def_readonly("correction", &LoopCandidate::correction, "Of the pose that the graph had, m.")
      .def(pickling<LoopCandidate>());
  py::class_<MapFix>(module, "MapFix", "A GNSS fix with its place in the map.")
      .def_readonly("id", &MapFix::id)
      .def_readonly("keyframe", &MapFix::keyframe,
                    "Id of the keyframe among whose sweeps it falls.")
      .def_property_readonly(
          "stamp", [](const MapFix& self) { return self.stamp.count(); }, "ns.")
      .def_property_readonly(
          "kind", [](const MapFix& self) { return python::name_of(self.kind); }, "As GnssFix.kind.")
      .def_property_readonly(
          "latitude", [](const MapFix& self) { return self.place.latitude; }, "Degrees.")
      .def_property_readonly(
          "longitude", [](const MapFix& self) { return self.place.longitude; }, "Degrees.")
      .def_property_readonly(
          "altitude", [](const MapFix& self) { return self.place.altitude; },
          "m above the ellipsoid.")
      .def_property_readonly(
          "covariance", [](const MapFix& self) { return array_of(self.covariance); },
          "(3, 3), as it counts: m^2, east north up.")
      .def_property_readonly(
          "verdict", [](const MapFix& self) { return std::string(to_string(self.verdict)); },
          "waiting, used, thinned, outlier, frozen, impossible or apart.")
      .def_readonly("chi2", &MapFix::chi2, "Of its distance from where the map has it.")
      .def(pickling<MapFix>());
}

void bind_georeference(py::module_& module) {
  py::class_<Georeference>(module, "Georeference", "Where a map lies on the Earth.")
      .def_property_readonly(
          "origin",
          [](const Georeference& self) {
            return py::make_tuple(self.origin.latitude, self.origin.longitude,
                                  self.origin.altitude);
          },
          "Of the world frame: latitude and longitude in degrees, altitude in m (WGS 84).")
      .def_property_readonly(
          "T_world_map", [](const Georeference& self) { return array_of(self.T_world_map); },
          "(4, 4): maps coordinates of the map to the world's, x east, y north, z up; m.")
      .def_property_readonly(
          "covariance", [](const Georeference& self) { return array_of(self.covariance); },
          "(6, 6), of T_world_map: [translation, rotation], m and rad.")
      .def(
          "place_of",
          [](const Georeference& self, const py::object& position) {
            const Geodetic place =
                WorldFrame(self.origin)
                    .place_of(self.T_world_map * vector_of(position, "position"));
            return py::make_tuple(place.latitude, place.longitude, place.altitude);
          },
          py::arg("position"),
          "(latitude, longitude, altitude) of (3,) in the map, m. TypeError, ValueError.")
      .def(
          "position_of",
          [](const Georeference& self, double latitude, double longitude, double altitude) {
            const Eigen::Vector3d world =
                WorldFrame(self.origin)
                    .position_of(
                        {.latitude = latitude, .longitude = longitude, .altitude = altitude});
            return array_of(Eigen::Vector3d(self.T_world_map.inverse() * world));
          },
          py::arg("latitude"), py::arg("longitude"), py::arg("altitude"),
          "(3,) in the map, m, of a place on WGS 84; degrees, m.")
      .def(pickling<Georeference>());
}

void bind_submap(py::module_& module) {
  py::class_<Submap>(module, "Submap", "What a keyframe has seen, in its own axes.")
      .def_readonly("keyframe", &Submap::keyframe, "Id of its keyframe.")
      .def_readonly("resolution", &Submap::r_submap, "Edge of the cells points were merged in, m.")
      .def_property_readonly(
          "points",
          [](const py::object& self) { return rows(self.cast<const Submap&>().points, self); },
          "(n, 3) float32, m, axes of the keyframe; a view.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) { return rows(self.cast<const Submap&>().directions, self); },
          "(n, 3) float32, unit; zero where a point lies on no plane. A view.")
      .def_property_readonly(
          "moving",
          [](const py::object& self) {
            return view_of(self.cast<const Submap&>().seen_through, self).attr("view")("bool");
          },
          "(n,) bool: other sweeps saw through it. A view.")
      .def_property_readonly(
          "sweep_of",
          [](const py::object& self) { return view_of(self.cast<const Submap&>().sweep_of, self); },
          "(n,) uint16: the sweep whose sensor was nearest, an index into sweeps. A view.")
      .def_property_readonly(
          "sweeps",
          [](const Submap& self) {
            Poses poses;
            for (const SubmapSweep& sweep : self.sweeps) {
              poses.push_back({.stamp = sweep.stamp, .pose = sweep.T_keyframe_lidar});
            }
            return poses_of(poses, {});
          },
          "A Trajectory: the poses of its sweeps, T_keyframe_lidar.")
      .def("__len__", [](const Submap& self) { return self.sweep_of.size(); })
      .def(pickling<Submap>());
}

/// Getters of what the database has as a list or a value.
template <class Member>
auto getter(Member member) {
  return [member](OpenMap& self) {
    return self.with([&](const MapDatabase& map) { return (map.*member)(); });
  };
}

}  // namespace

void bind_map(py::module_& module) {
  bind_records(module);
  bind_georeference(module);
  bind_submap(module);
  py::class_<OpenMap, std::shared_ptr<OpenMap>>(
      module, "Map",
      "A map in a file, as `adit run` leaves OUT/map.adit and finish_map() does; it is read, also\n"
      "while another process writes it. Whatever is damaged raises InputError.")
      .def(py::init([](const std::filesystem::path& file) {
             return without_gil([&] { return std::make_shared<OpenMap>(file); });
           }),
           py::arg("path"), "InputError: missing, no map, damaged, of a newer version.")
      .def_property_readonly(
          "path", [](OpenMap& self) { return self.file(); }, "Its file.")
      .def_property_readonly("sessions", getter(&MapDatabase::sessions), "The recordings in it.")
      .def_property_readonly("keyframes", getter(&MapDatabase::keyframes),
                             "In the order of their ids, the nodes of the pose graph.")
      .def_property_readonly(
          "edges",
          [](OpenMap& self) {
            return self.with([](const MapDatabase& map) { return map.graph().edges(); });
          },
          "Of the pose graph, as they were stored.")
      .def_property_readonly("loops", getter(&MapDatabase::candidates),
                             "Places that might have been seen before, with what became of that.")
      .def_property_readonly("fixes", getter(&MapDatabase::fixes), "GNSS fixes.")
      .def_property_readonly("georeference", getter(&MapDatabase::georeference),
                             "Where it lies on the Earth; None: that is not known.")
      .def(
          "submap",
          [](OpenMap& self, NodeId keyframe) {
            std::optional<Submap> found =
                self.with([&](const MapDatabase& map) -> std::optional<Submap> {
                  if (!map.keyframe(keyframe)) {
                    return std::nullopt;
                  }
                  return read_submap(map, keyframe);
                });
            if (!found) {
              throw py::key_error(fmt::format("the map has no keyframe {}", keyframe));
            }
            return std::move(*found);
          },
          py::arg("keyframe"), "The submap of a keyframe, by its id. KeyError, InputError.")
      .def(
          "within",
          [](OpenMap& self, const py::object& lower, const py::object& upper) {
            const Eigen::Vector3d from = vector_of(lower, "lower");
            const Eigen::Vector3d to = vector_of(upper, "upper");
            return self.with([&](const MapDatabase& map) { return map.submaps_within(from, to); });
          },
          py::arg("lower"), py::arg("upper"),
          "Ids of the keyframes whose submaps may reach into a box. lower, upper: (3,), corners "
          "in\n"
          "the map, m. TypeError, ValueError.")
      .def(
          "trajectory",
          [](OpenMap& self) {
            return self.with([](const MapDatabase& map) {
              return poses_of(map_trajectory(map, map.file()), map_parts(map, map.file()));
            });
          },
          "A Trajectory: T_map_lidar of every sweep, as the map has it now.")
      .def("check", getter(&MapDatabase::check),
           "What is wrong with it, a sentence each; empty: it is whole. Reads everything.")
      .def("close", &OpenMap::close,
           "Closes its file; `with adit.Map(...) as map` does at the end of the block. What reads\n"
           "it then raises ValueError.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](OpenMap& self, const py::args&) { self.close(); })
      .def("__repr__", [](OpenMap& self) { return "<adit.Map " + self.file().string() + ">"; });
}

}  // namespace adit::python
