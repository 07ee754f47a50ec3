// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/range_sensor.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/scene_caster.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// What keeps a range sensor from being perfect. Switched one by one.
struct RangeEffects {
  bool noise = true;         ///< noise of the range, and its resolution
  bool dropout = true;       ///< surfaces that are dark, far or seen at a slant give no return
  bool mixed_pixels = true;  ///< a beam on an edge measures between the two surfaces
  bool dust = true;          ///< as much as the scene has
  bool reflections = false;  ///< glass mirrors, too, by Fresnel's equations
};

/// What came back of one firing.
struct Return {
  double range = 0.0;      ///< m; 0: nothing
  float intensity = 0.0F;  ///< in the sensor's own scale
  float doppler = 0.0F;    ///< m/s, how fast the range grows; of sensors that measure it
  uint16_t object = 0;     ///< 0: what stands still or dust; n: moving object n - 1 of the scene
  /// 0: no surface is there, the echo is of dust or melted of two surfaces. kMirrored, kCarrier:
  /// none is there, either. Otherwise the material plus 1, and kLevelSurface where it is level.
  uint8_t surface = 0;
  SurfaceColor color{};  ///< of the surface, where that was asked for; black where there is none
};
/// Flag of surfaces that face upwards within 45 degrees, world frame.
inline constexpr uint8_t kLevelSurface = 128;
/// What a pane of glass mirrors: it is measured behind the pane.
inline constexpr uint8_t kMirrored = 127;
/// A part of what carries the sensor.
inline constexpr uint8_t kCarrier = 126;

/// The pulses of a sweep and what came back, one for one.
struct RangeSweep {
  int64_t start = 0;  ///< ns from the start of the recording
  std::vector<Firing> firings;
  std::vector<Return> returns;
  bool doppler = false;  ///< the returns have it
};

/// How the sensor is carried.
struct RangeMount {
  const SplineTrajectory* trajectory = nullptr;
  Eigen::Isometry3d T_body_lidar = Eigen::Isometry3d::Identity();
};

/// Casts every pulse from where the sensor is at that moment, at the scene as it is at that moment.
class RangeSimulator {
 public:
  /// Scene and trajectory must outlive it. Returns have the colour of their surface where
  /// `color_seed` is given.
  RangeSimulator(const Scene& scene, RangeSensor sensor, const RangeMount& mount, uint64_t seed,
                 const RangeEffects& effects = {}, std::optional<uint64_t> color_seed = {});

  /// Sweep `index`, counted from the start of the recording. The same whatever the number of
  /// threads and whichever sweeps were asked for before.
  RangeSweep sweep(int64_t index, const Checkpoint& checkpoint = {}) const;

  /// T_world_lidar at a time in s from the start of the recording.
  Eigen::Isometry3d pose(double time) const {
    return mount_.trajectory->pose(time) * mount_.T_body_lidar;
  }

  const RangeSensor& sensor() const { return sensor_; }
  const RayScene& still() const { return caster_.still(); }
  const SceneCaster& caster() const { return caster_; }

 private:
  struct Pulse {
    const Firing* firing = nullptr;
    uint64_t number = 0;                         ///< over the whole recording
    double time = 0.0;                           ///< s
    const MotionState* motion = nullptr;         ///< of the body by then, for the Doppler speed
    const std::vector<Mover>* movers = nullptr;  ///< moving objects within reach
  };

  /// A surface, seen directly, through glass or in a mirror.
  struct Sight {
    SceneHit target;
    double share = 1.0;  ///< of the pulse's power that glass leaves on the way there and back
    bool mirrored = false;
  };

  std::vector<Mover> movers_near(const RangeSweep& sweep) const;
  Return measure(const Pulse& pulse, const Eigen::Isometry3d& T_world_lidar) const;
  std::optional<Sight> first_surface(const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction, const Pulse& pulse,
                                     uint64_t lane) const;
  /// What a pane mirrors of a pulse whose `share` of power reaches it.
  std::optional<Sight> mirrored(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                const SceneHit& pane, double share, const Pulse& pulse) const;
  /// The pane is so square to the pulse that the sensor sees its own light in it.
  bool faces_sensor(const SceneHit& pane, const Eigen::Vector3d& direction) const;
  /// The echo of dust nearer than `reach` (m), where there is one.
  std::optional<Return> scattered_by_dust(const Pulse& pulse, const Eigen::Vector3d& origin,
                                          const Eigen::Vector3d& direction, double reach) const;
  static uint8_t surface_of(const Sight& seen);
  double strength(const Sight& seen, const Eigen::Vector3d& direction) const;
  /// How fast the range of something grows, m/s: of what stands still, or of moving object n - 1
  /// of the scene at a point of the world.
  float radial_speed(const Pulse& pulse, const Eigen::Vector3d& direction, uint16_t object,
                     const Eigen::Vector3d& p_world) const;

  SceneCaster caster_;
  RangeSensor sensor_;
  RangeMount mount_;
  RangeEffects effects_;
  uint64_t seed_;
  std::optional<uint64_t> color_seed_;
};

}  // namespace adit
