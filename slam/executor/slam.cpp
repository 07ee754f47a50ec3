// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/slam.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"

namespace adit {
namespace {

/// For the map, s.
struct Waits {
  double sum = 0.0;
  double longest = 0.0;
};

/// A wait as long as its life.
class Waiting {
 public:
  explicit Waiting(Waits& waits) : waits_(waits) {}
  ~Waiting() {
    const double wait = seconds();
    waits_.sum += wait;
    waits_.longest = std::max(waits_.longest, wait);
  }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

  /// By now.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  Waits& waits_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One thread: what a keyframe asks of the map is done when it comes, so that it is ready when it
/// is to take effect, and the next sweep waits meanwhile.
class OfflineSlam final : public Slam {
 public:
  OfflineSlam(engine::Context& context, const Config& config, const SlamOptions& options)
      : configured_(config.imu.T_imu_lidar),
        gnss_(config.gnss),
        inertial_(options.inertial && config.imu.use),
        feed_(inertial_),
        odometry_(context, config),
        context_(&context),
        map_(options.map),
        session_(options.session),
        map_memory_(options.map_memory) {
    if (options.high_rate_smoothing) {
      high_rate_.emplace(config.imu, *options.high_rate_smoothing);
    }
  }

  void add(Measurement measurement, std::string_view frame) override {
    std::string* named = std::holds_alternative<Sweep>(measurement)       ? &lidar_frame_
                         : std::holds_alternative<ImuSample>(measurement) ? &imu_frame_
                                                                          : &gnss_frame_;
    if (named->empty()) {
      *named = frame;
    }
    if (auto* fix = std::get_if<GnssFix>(&measurement)) {
      if (map_ == nullptr || !gnss_.use) {
        return;
      }
      fix->stamp += nanoseconds(gnss_.time_offset);
    }
    feed_.add(std::move(measurement));
  }

  void add(const StaticTransform& transform) override { transforms_.add(transform); }

  void flush() override { feed_.flush(); }

  std::optional<SlamResult> next() override {
    while (taken_.empty()) {
      std::optional<Measurement> due = feed_.next();
      if (!due) {
        return std::nullopt;
      }
      if (auto* sweep = std::get_if<Sweep>(&*due)) {
        return place(std::move(*sweep));
      }
      if (const auto* reading = std::get_if<ImuSample>(&*due)) {
        take(*reading);
      } else {
        take(std::get<GnssFix>(*due));
      }
    }
    ReadingTaken taken = std::move(taken_.front());
    taken_.pop_front();
    return taken;
  }

  std::optional<Mounting> mounting() const override { return mounting_; }

  const Config& config() const override { return odometry_.config(); }

  std::optional<MapReport> finish_map() override {
    if (map_ == nullptr) {
      return std::nullopt;
    }
    const Waiting waiting(other_waits_);
    begin_map();
    mapper_->finish();
    MapReport report = mapper_->report();
    report.waited_s = sweep_waits_.sum + other_waits_.sum + waiting.seconds();
    report.longest_wait_s = sweep_waits_.longest;
    return report;
  }

 private:
  void take(const ImuSample& reading) {
    for (const TakenReading& known : odometry_.add(reading)) {
      taken_.push_back(
          {.arrival = known.arrival,
           .motion = high_rate_ ? high_rate_->add(known.sample, known.arrival) : std::nullopt});
    }
  }

  void take(const GnssFix& fix) {
    if (!mapper_) {
      before_map_fixes_.push_back(fix);
      return;
    }
    mapper_->add(fix, antenna());
  }

  Eigen::Vector3d antenna() {
    if (!p_lidar_antenna_) {
      const bool named = !gnss_frame_.empty() && !lidar_frame_.empty();
      const auto told = named ? transforms_.transform(lidar_frame_, gnss_frame_) : std::nullopt;
      p_lidar_antenna_ = gnss_.antenna ? Eigen::Vector3d(gnss_.antenna->data())
                         : told        ? Eigen::Vector3d(told->translation())
                                       : Eigen::Vector3d::Zero();
    }
    return *p_lidar_antenna_;
  }

  SlamResult place(Sweep sweep) {
    if (last_sweep_ && sweep.stamp <= *last_sweep_) {
      return SweepLeftOut{.sweep = std::move(sweep), .last = *last_sweep_};
    }
    last_sweep_ = sweep.stamp;
    if (inertial_ && !mounting_) {
      mounting_ = find_mounting();
      odometry_.mount(mounting_->T_imu_lidar);
    }
    SweepResult result = odometry_.step(sweep);
    if (high_rate_) {
      high_rate_->update(result.inertial);
    }
    // After the odometry is done with the sweep: a map changes nothing of it.
    const double waited = sweep_waits_.sum + other_waits_.sum;
    std::optional<MapPlacement> mapped = add_to_map(sweep, result);
    return SweepPlaced{.sweep = std::move(sweep),
                       .result = std::move(result),
                       .mapped = std::move(mapped),
                       .map_ms = 1e3 * (sweep_waits_.sum + other_waits_.sum - waited)};
  }

  /// Lengths of the map are known once the odometry has begun; what came before it has no points.
  std::optional<MapPlacement> add_to_map(const Sweep& sweep, const SweepResult& result) {
    if (map_ == nullptr) {
      return std::nullopt;
    }
    if (!mapper_ && result.state == OdometryState::coasting) {
      before_map_.push_back(result);
      return std::nullopt;
    }
    if (!mapper_) {
      const Waiting waiting(other_waits_);
      begin_map();
    }
    const Waiting waiting(sweep_waits_);
    return mapper_->add(sweep, result, odometry_.cloud());
  }

  void begin_map() {
    if (mapper_) {
      return;
    }
    mapper_.emplace(*context_, odometry_.config(), *map_, session_, map_memory_);
    for (const GnssFix& fix : std::exchange(before_map_fixes_, {})) {
      take(fix);
    }
    for (const SweepResult& result : before_map_) {
      static_cast<void>(mapper_->add(Sweep{}, result, {}));
    }
    before_map_.clear();
  }

  Mounting find_mounting() const {
    if (configured_) {
      return {.source = MountingSource::configured, .T_imu_lidar = pose_of(*configured_)};
    }
    const bool named = !imu_frame_.empty() && !lidar_frame_.empty();
    const auto told = named ? transforms_.transform(imu_frame_, lidar_frame_) : std::nullopt;
    // By its numbers, so that the same setting gives the same bytes.
    return told ? Mounting{.source = MountingSource::transforms,
                           .T_imu_lidar = pose_of(numbers_of(*told))}
                : Mounting{.source = MountingSource::assumed};
  }

  std::optional<std::array<double, 7>> configured_;
  GnssConfig gnss_;
  bool inertial_;
  SensorFeed feed_;
  Odometry odometry_;
  engine::Context* context_;
  MapStore* map_;
  SessionId session_;
  MapMemory map_memory_;
  Waits sweep_waits_;
  Waits other_waits_;  ///< at the map's beginning and end
  std::optional<Mapper> mapper_;
  std::vector<SweepResult> before_map_;  ///< results of sweeps before the odometry began
  std::vector<GnssFix> before_map_fixes_;
  std::optional<HighRateStream> high_rate_;
  std::deque<ReadingTaken> taken_;  ///< not asked for yet
  FrameTree transforms_;
  std::string lidar_frame_;
  std::string imu_frame_;
  std::string gnss_frame_;
  std::optional<Eigen::Vector3d> p_lidar_antenna_;  ///< once it is asked for
  std::optional<Mounting> mounting_;
  std::optional<Nanoseconds> last_sweep_;  ///< its stamp
};

}  // namespace

std::unique_ptr<Slam> make_slam(engine::Context& context, const Config& config,
                                const SlamOptions& options) {
  return std::make_unique<OfflineSlam>(context, config, options);
}

}  // namespace adit
