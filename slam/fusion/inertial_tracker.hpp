// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/prediction.hpp"
#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/fusion/sliding_graph.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"
#include "adit/slam/inertial/reading_gate.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit {

/// What the inertial sensor does for the odometry.
enum class InertialState {
  absent,    ///< no readings came, or it is not to be used
  starting,  ///< gravity, biases and velocity are not known yet: the lidar goes alone
  fused,
  lost,     ///< a check failed: the lidar goes alone until the sensor has been started again
  refused,  ///< it was lost again and again: it stays out
};
std::string_view to_string(InertialState state);

/// What a sweep told of the inertial sensor.
struct InertialReport {
  InertialState state = InertialState::absent;
  std::optional<InertialEvent> event;          ///< that came with this sweep
  std::optional<InertialHindrance> hindrance;  ///< what keeps the sensor from being started
  std::optional<NavState> nav;                 ///< of the body, where this sweep was fused
  /// Of nav, in the order of its tangent vectors: what the sliding graph leaves on its newest
  /// state.
  StateMatrix nav_covariance = StateMatrix::Zero();
  /// Of T_map_lidar relative to the submap, lidar axes, [rho, phi]: of nav and of the alignment,
  /// whose errors are partly those of the sweeps before; zero where there is neither.
  Matrix6d lidar_covariance = Matrix6d::Zero();
  Eigen::Vector3d gravity_map = Eigen::Vector3d::Zero();  ///< m/s²; zero before a start
  Innovation innovation;         ///< of the alignment; 0 degrees where there was none
  double innovation_gate = 0.0;  ///< of its nis: what lies beyond is not believed
  double bridged_gap = 0.0;      ///< s, the longest time without readings that was bridged
  bool compared = false;         ///< prediction and constant velocity, against the alignment:
  bool better_turn = false;      ///< the inertial prediction's rotation was nearer
  bool better_travel = false;    ///< its translation was
  double accel_scale = 1.0;      ///< from the accelerometer's own unit and sign to m/s²
  Eigen::Isometry3d T_body_lidar = Eigen::Isometry3d::Identity();  ///< refined, if it is to be
  double clock_offset = 0.0;  ///< s, taken off the stamps of readings; 0 unless it is refined
  /// The gyroscope against the sweeps, as they come: the latest that the motion told.
  std::optional<RotationComparison> comparison;
};

/// The noise that the settings assume: a sensor's by name, or their own.
ImuNoise imu_noise(const ImuConfig& config);

/// What the readings say of the next sweep.
struct InertialPrediction {
  Prediction lidar;
  std::optional<SweepMotion> motion;  ///< none for a sweep without duration
};

/// Starts the inertial sensor, predicts sweeps with it, fuses it with their alignments in the
/// sliding graph, and checks that it does what it should (docs/theory/inertial.md, section 6).
class InertialTracker {
 public:
  /// `config` must have passed validate(). `configured_offset` (s) is what the stamps of readings
  /// have in them of recording.imu_time_offset: remedies name the sum.
  explicit InertialTracker(const ImuConfig& config, double configured_offset = 0.0);

  /// In place of the settings' mounting, before the first sweep.
  void mount(const Eigen::Isometry3d& T_imu_lidar) { T_body_lidar_ = T_imu_lidar; }

  /// Takes a reading. Returns those whose fate is known with it: one that jumps waits for the next.
  std::vector<TakenReading> add(const ImuSample& sample);

  /// Attitude of the lidar in a map whose z is up, as the readings of that time have it: within a
  /// few degrees for a sensor that moves. None without readings.
  std::optional<Eigen::Matrix3d> level_lidar(Nanoseconds begin, Nanoseconds end) const;

  /// Before the first start: the readings of that time are those of a sensor at rest, or of one
  /// that goes on as it went.
  bool is_quiet_between(Nanoseconds begin, Nanoseconds end) const;

  /// The sweep that begins at `stamp` and lasts `duration` s. None while the sensor is not fused.
  std::optional<InertialPrediction> predict(Nanoseconds stamp, double duration);

  /// Before the first start the gyroscope alone can be used, with its bias: how the lidar turned in
  /// that time, R_begin_end. None once started, without readings, or if it turned otherwise than
  /// alignments said.
  std::optional<Eigen::Matrix3d> turn(Nanoseconds begin, Nanoseconds end) const;
  /// The same over a sweep, with the translation of a constant velocity (m/s, lidar axes).
  std::optional<SweepMotion> turning_motion(Nanoseconds stamp, double duration,
                                            const Eigen::Vector3d& velocity) const;

  /// The pose of a sweep that was aligned, or bridged by a prediction where `alignment` is null;
  /// `steady` is what constant velocity predicted, `deskewed` what the sweep was de-skewed with, if
  /// it was. Where the report has a nav, that is the outcome.
  InertialReport update(const StampedPose& T_map_lidar, const RegistrationResult* alignment,
                        const Eigen::Isometry3d& steady, const SweepMotion* deskewed = nullptr);

  /// The map begins with this sweep: its pose is known by definition.
  void note_begin(const StampedPose& T_map_lidar);

  /// The submap starts anew: where no inertial prediction led there, the attitude is not the one
  /// from before, nor is gravity's direction in the map.
  void note_restart() { after_gap_ = false; }

  /// What nav says of the lidar.
  Eigen::Isometry3d T_map_lidar(const NavState& nav) const {
    return nav.T_map_body * T_body_lidar_;
  }

 private:
  /// Saturation is told when none was for so long, and with what else goes wrong in that time.
  static constexpr Nanoseconds kToldAgain = std::chrono::seconds(10);

  struct Pending {
    std::vector<ImuSample> readings;
    StateEstimate prediction;
    double gap = 0.0;  ///< s, the longest among the readings; 0: none
  };
  struct Corrections {
    bool clock = false;
    bool mounting = false;
    double least_clock = 0.0;  ///< s; less stays as it is
    double sigmas = 0.0;       ///< what is within so many standard deviations stays as it is
  };
  struct Trial {
    int sweeps = 0;
    int better = 0;  ///< than constant velocity, their turns
  };

  ImuArrival take(const ImuSample& sample);
  std::vector<ImuSample> scaled(std::vector<ImuSample> samples) const;
  /// What is wrong with the coverage; none if nothing is.
  std::optional<CoverageFault> complaint(const ImuInterval& interval) const;
  /// What is wrong with a prediction from the newest state of the graph; none if nothing is.
  std::optional<ImpossibleState> impossible_motion(const StateEstimate& prediction) const;
  std::optional<FailedCheck> failed_check(const StateEstimate& estimate) const;
  void lose(const FailedCheck& check);
  /// What else explains a check that failed, and passes: saturation within the last ten seconds, a
  /// gap that was bridged.
  std::optional<PassingCause> passing_cause() const;
  /// Stops fusing, to start anew or not at all.
  void leave(InertialState state, const InertialCause& why);
  /// Holds the gyroscope against the sweeps; corrects the sensor where they contradict it and say
  /// by how much, else refuses it.
  void watch(const StampedPose& alignment, const SweepMotion* deskewed);
  void judge(const GyroCheck& check);
  /// Refuses a sensor that predicts badly though it was corrected.
  void try_out(const InertialReport& report);
  Eigen::Matrix3d R_lidar_body() const { return T_body_lidar_.linear().transpose(); }
  /// Corrects what may be, and says what it did; none if nothing.
  std::optional<SensorCorrected> correct(const GyroCheck& check, const Corrections& allowed);
  void fuse(const RegistrationResult* alignment, const Eigen::Isometry3d& steady,
            InertialReport& report);
  void collect(const StampedPose& T_map_lidar, bool aligned);
  void try_start();
  bool start_again_after_gap();
  void start(const NavState& state, const ImuStart& how);

  ImuConfig config_;
  ImuNoise noise_;
  Eigen::Isometry3d T_body_lidar_;
  ReadingGate gate_;
  ImuBuffer buffer_;
  GyroMonitor monitor_;
  SaturationWatch saturation_;
  StuckAxisWatch stuck_;
  GyroFault suspected_ = GyroFault::none;  ///< by the last check
  int corrections_ = 0;                    ///< of faults
  int unexplained_ = 0;                    ///< sweeps to wait for a comparison, as a check failed
  std::optional<Trial> trial_;             ///< of what was corrected
  std::optional<RotationComparison> comparison_;
  double clock_offset_ = 0.0;  ///< s
  double configured_offset_;   ///< s
  bool timed_ = false;         ///< points have times: a sweep's stamp is when it began
  InertialState state_ = InertialState::absent;
  std::optional<InertialEvent> event_;
  std::optional<InertialHindrance> hindrance_;
  double accel_scale_ = 1.0;
  std::optional<SlidingGraph> graph_;
  std::optional<Pending> pending_;
  std::optional<NavState> last_fused_;
  bool gyro_agrees_ = true;                ///< with alignments, as far as was seen before the start
  std::optional<Nanoseconds> bridged_at_;  ///< the last gap among the readings that was bridged
  bool after_gap_ = false;  ///< lost for want of readings alone: gravity and biases still hold
  /// Position in the map of a start at rest: the accelerometer's sign is an assumption until the
  /// sensor has gone away from there.
  std::optional<Eigen::Vector3d> rested_at_;
  int surprises_ = 0;                            ///< innovations beyond belief in a row
  int losses_ = 0;                               ///< since the last long time of fusion
  int fused_sweeps_ = 0;                         ///< in a row
  double alone_since_ = 0.0;                     ///< s without an alignment
  std::deque<StampedPose> poses_;                ///< of the body, aligned, in a row
  std::deque<std::vector<ImuSample>> readings_;  ///< between them, as they came
};

}  // namespace adit
