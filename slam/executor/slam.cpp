// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/slam.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "adit/slam/executor/receiver_mounts.hpp"
#include "adit/slam/executor/waits.hpp"
#include "adit/slam/executor/worker.hpp"
#include "adit/slam/inertial/doppler_velocity.hpp"

namespace adit {
namespace {

// Some seconds of a sensor. The points of more sweeps that wait for the map are released; it needs
// their down-sampled clouds.
constexpr std::size_t kMostWithPoints = 64;

/// The map takes up a sweep once the odometry is done with it, in a thread of its own, while the
/// odometry goes on with the next ones, at most SlamOptions::most_behind of them. next()
/// returns a sweep once it is in the map. The odometry takes nothing from the map, so that results
/// do not depend on which of the two is faster.
class OfflineSlam final : public Slam {
 public:
  OfflineSlam(engine::Context& context, const Config& config, const SlamOptions& options)
      : configured_(config.imu.T_imu_lidar),
        gnss_(config.gnss),
        mounts_(config.gnss),
        velocity_(config.velocity),
        inertial_(options.inertial && config.imu.use),
        feed_(inertial_, nanoseconds(config.imu.wait)),
        odometry_(context, config),
        context_(&context),
        map_(options.map),
        session_(options.session),
        map_memory_(options.map_memory),
        earlier_sessions_(options.earlier_sessions),
        start_(options.start),
        map_beside_(options.map_beside),
        most_behind_(options.most_behind),
        placed_(options.placed) {
    if (options.high_rate_smoothing) {
      high_rate_.emplace(config.imu, *options.high_rate_smoothing);
    }
  }

  void add(Measurement measurement, std::string_view frame) override {
    std::string& named = frames_[measurement.index()];
    const auto* velocity_of = std::get_if<BodyVelocity>(&measurement);
    const auto* heading_of = std::get_if<Heading>(&measurement);
    if (named.empty()) {
      named = velocity_of != nullptr  ? velocity_of->frame
              : heading_of != nullptr ? heading_of->frame
                                      : "";
      named = named.empty() ? std::string(frame) : named;
    }
    has_readings_ = has_readings_ || std::holds_alternative<ImuSample>(measurement);
    if (auto* fix = std::get_if<GnssFix>(&measurement)) {
      if (map_ == nullptr || !gnss_.use) {
        return;
      }
      fix->stamp += nanoseconds(gnss_.time_offset);
    }
    if (auto* heading = std::get_if<Heading>(&measurement)) {
      if (map_ == nullptr || !gnss_.use || !gnss_.heading) {
        return;
      }
      heading->stamp += nanoseconds(gnss_.time_offset);  // of the same receiver, as a rule
    }
    if (auto* velocity = std::get_if<BodyVelocity>(&measurement)) {
      if (!inertial_ || !velocity_.use) {
        return;
      }
      velocity->stamp += nanoseconds(velocity_.time_offset);
    }
    flushing_ = false;
    if (std::optional<Measurement> passed = gate_.pass(std::move(measurement))) {
      feed_.add(std::move(*passed));
    }
  }

  void add(const StaticTransform& transform) override {
    if (gate_.pass(transform)) {
      transforms_.add(transform);
      transforms_are_new_ = true;
    }
  }

  MeasurementFaults faults() const override { return gate_.faults(); }

  void flush() override {
    feed_.flush();
    flushing_ = true;
  }

  std::optional<SlamResult> next() override {
    while (true) {
      if (!results_.empty() && is_known(results_.front())) {
        return take_front();
      }
      if (map_failure_ && results_.empty()) {
        if (std::exchange(map_error_told_, true)) {
          return std::nullopt;
        }
        std::rethrow_exception(map_failure_);
      }
      if (failed_ || map_failure_) {
        settle();  // what came before the failure is told first
      } else if (std::optional<Measurement> due = feed_.next()) {
        take_or_fail(std::move(*due));
        if (!map_beside_) {
          wait_for_map();
        }
      } else if (results_.empty() || !flushing_) {
        return std::nullopt;
      } else {
        settle();
      }
    }
  }

  void settle() override {
    wait_until_behind(0);
    if (last_fix_.valid()) {
      last_fix_.get();
    }
  }

  std::optional<Mounting> mounting() const override { return mounting_; }

  const Config& config() const override { return odometry_.config(); }

  std::optional<MapReport> finish_map() override {
    if (map_ == nullptr) {
      return std::nullopt;
    }
    settle();
    if (map_error_ && !std::exchange(map_error_told_, true)) {
      std::rethrow_exception(map_error_);
    }
    begin_map();
    if (map_error_) {
      finish_failed_map();
      return std::nullopt;
    }
    mapper_->finish();
    MapReport report = mapper_->report();
    report.gnss.left_out = gate_.faults().fixes_left_out;
    report.gnss.heading.left_out = gate_.faults().headings_left_out;
    report.waited_s = waits_.sum;
    report.longest_wait_s = waits_.longest;
    return report;
  }

 private:
  /// What is known by now goes into the map. It is not whole, for a reason that was thrown before.
  void finish_failed_map() {
    try {
      mapper_->finish();
    } catch (const std::exception&) {
      // As expected: its store or its device has failed already.
    }
  }

  /// A sweep that the odometry has placed, on its way into the map.
  struct InMap {
    SweepPlaced placed;
    std::vector<Point> cloud;  ///< down-sampled, lidar axes
    std::shared_future<MapPlacement> mapped;
  };
  /// A measurement with where its sensor sits, or which way it points, in the lidar's axes.
  template <class Kind>
  struct Mounted {
    Kind measured;
    Eigen::Vector3d mounting;
  };
  /// What the map takes besides sweeps.
  using ForMap = std::variant<Mounted<GnssFix>, Mounted<Heading>>;
  using Result = std::variant<SlamResult, std::unique_ptr<InMap>, std::exception_ptr>;

  template <class Kind>
  const std::string& frame_of() const {
    return frames_[Measurement(Kind{}).index()];
  }

  static bool is_ready(const std::shared_future<MapPlacement>& placement) {
    return placement.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  static bool is_known(const Result& result) {
    const auto* in_map = std::get_if<std::unique_ptr<InMap>>(&result);
    return in_map == nullptr || is_ready((*in_map)->mapped);
  }

  SlamResult take_front() {
    Result front = std::move(results_.front());
    results_.pop_front();
    if (auto* known = std::get_if<SlamResult>(&front)) {
      return std::move(*known);
    }
    if (const auto* failure = std::get_if<std::exception_ptr>(&front)) {
      failed_ = false;
      std::rethrow_exception(*failure);
    }
    InMap& in_map = *std::get<std::unique_ptr<InMap>>(front);
    try {
      in_map.placed.mapped = in_map.mapped.get();
    } catch (...) {
      map_failure_ = std::current_exception();  // the odometry has placed the sweep all the same
    }
    return std::move(in_map.placed);
  }

  /// Until the map is at most so many sweeps behind.
  void wait_until_behind(std::size_t sweeps) {
    for (; behind_.size() > sweeps; behind_.pop_front()) {
      behind_.front().wait();
    }
  }

  /// As the run goes on, which the report tells.
  void wait_for_map(std::size_t behind = 0) {
    const Waiting waiting(waits_);
    wait_until_behind(behind);
  }

  /// What fails is told behind what was known before it.
  void take_or_fail(Measurement due) {
    try {
      take(std::move(due));
    } catch (...) {
      failed_ = true;
      results_.emplace_back(std::current_exception());
    }
  }

  void take(Measurement due) {
    if (auto* sweep = std::get_if<Sweep>(&due)) {
      place(std::move(*sweep));
    } else if (const auto* reading = std::get_if<ImuSample>(&due)) {
      take(*reading);
    } else if (const auto* velocity = std::get_if<BodyVelocity>(&due)) {
      odometry_.add(*velocity, VelocitySource::sensor);
    } else if (const auto* heading = std::get_if<Heading>(&due)) {
      take_for_map(Mounted<Heading>{*heading, heading_axis()});
    } else {
      take_for_map(Mounted<GnssFix>{std::get<GnssFix>(due), antenna()});
    }
  }

  void take(const ImuSample& reading) {
    for (const TakenReading& known : odometry_.add(reading)) {
      results_.emplace_back(SlamResult(ReadingTaken{
          .arrival = known.arrival,
          .motion = high_rate_ ? high_rate_->add(known.sample, known.arrival) : std::nullopt}));
    }
  }

  void take_for_map(const ForMap& measured) {
    if (!mapper_) {
      before_map_measured_.push_back(measured);
      return;
    }
    last_fix_ = worker_.run([this, measured] { map_fix(measured); });
  }

  /// The worker's.
  void map_fix(const ForMap& measured) {
    if (map_error_) {
      return;
    }
    try {
      std::visit([this](const auto& one) { mapper_->add(one.measured, one.mounting); }, measured);
    } catch (...) {
      map_error_ = std::current_exception();  // the next sweep's, or finish_map()'s
    }
  }

  /// T_lidar_sensor, by the static transforms that have arrived.
  template <class Kind>
  std::optional<Eigen::Isometry3d> mounted() const {
    const std::string& sensor = frame_of<Kind>();
    const std::string& lidar = frame_of<Sweep>();
    return sensor.empty() || lidar.empty() ? std::nullopt : transforms_.transform(lidar, sensor);
  }

  Eigen::Vector3d antenna() {
    return mounts_.antenna([this] { return mounted<GnssFix>(); });
  }
  Eigen::Vector3d heading_axis() {
    return mounts_.heading_axis([this] { return mounted<Heading>(); });
  }

  /// The frame of a sensor is known once one of its measurements has arrived.
  void look_up_mounting() {
    const bool open =
        !mounting_ || (transforms_are_new_ && mounting_->source == MountingSource::assumed);
    if (!inertial_ || !has_readings_ || !open) {
      return;
    }
    transforms_are_new_ = false;
    const Mounting found = find_mounting();
    if (!mounting_ || found.source != MountingSource::assumed) {
      odometry_.mount(found.T_imu_lidar);
    }
    mounting_ = found;
  }

  /// Until its transform has arrived, the settings' mounting stands, or the lidar's axes.
  void look_up_velocity_mounting() {
    if (velocity_.T_lidar_sensor || velocity_is_mounted_) {
      return;
    }
    if (const auto T_lidar_sensor = mounted<BodyVelocity>()) {
      odometry_.mount_velocity(*T_lidar_sensor);
      velocity_is_mounted_ = true;
    }
  }

  /// Points that move are taken out, as without a return: how many.
  std::size_t take_doppler(Sweep& sweep) {
    const auto fit = velocity_.doppler ? fit_doppler(sweep) : std::nullopt;
    if (!fit) {
      return 0;
    }
    odometry_.add(fit->velocity, VelocitySource::doppler);
    for (const std::size_t i : fit->moving) {
      sweep.points[i] = Point{};
    }
    return fit->moving.size();
  }

  void place(Sweep sweep) {
    if (last_sweep_ && sweep.stamp <= *last_sweep_) {
      results_.emplace_back(
          SlamResult(SweepLeftOut{.sweep = std::move(sweep), .last = *last_sweep_}));
      return;
    }
    last_sweep_ = sweep.stamp;
    look_up_mounting();
    look_up_velocity_mounting();
    const std::size_t moving = take_doppler(sweep);
    SweepResult result = odometry_.step(sweep);
    result.moving_points = static_cast<int>(moving);
    if (high_rate_) {
      high_rate_->update(result.inertial);
    }
    if (placed_) {
      placed_(sweep, result);
    }
    SweepPlaced placed{.sweep = std::move(sweep), .result = std::move(result)};
    // After the odometry is done with the sweep: a map changes nothing of it.
    if (goes_into_map(placed.result)) {
      add_to_map(std::move(placed));
    } else {
      results_.emplace_back(SlamResult(std::move(placed)));
    }
  }

  /// Lengths of the map are known once the odometry has begun; what came before it has no points.
  bool goes_into_map(const SweepResult& result) {
    if (map_ != nullptr && !mapper_ && result.state == OdometryState::coasting) {
      before_map_.push_back(result);
      return false;
    }
    return map_ != nullptr;
  }

  void add_to_map(SweepPlaced placed) {
    const auto start = std::chrono::steady_clock::now();
    begin_map();
    wait_for_map(most_behind_ - 1);
    placed.map_ms = 1e3 * elapsed_since(start);
    while (!behind_.empty() && is_ready(behind_.front())) {
      behind_.pop_front();
    }
    if (behind_.size() >= kMostWithPoints) {
      placed.sweep.points = {};
      placed.sweep.times = {};
      placed.sweep.rings = {};
      placed.sweep.doppler = {};
    }
    auto in_map = std::make_unique<InMap>(
        InMap{.placed = std::move(placed), .cloud = odometry_.cloud(), .mapped = {}});
    in_map->mapped = worker_.run([this, given = in_map.get()] { return map_sweep(*given); });
    behind_.push_back(in_map->mapped);
    results_.emplace_back(std::move(in_map));
  }

  /// The worker's. Behind a sweep that the map could not take it takes none.
  MapPlacement map_sweep(InMap& given) {
    if (map_error_) {
      std::rethrow_exception(map_error_);
    }
    SweepPlaced& sweep = given.placed;
    sweep.map_begun = std::chrono::steady_clock::now();
    try {
      const MapPlacement placement = mapper_->add(sweep.sweep, sweep.result, given.cloud);
      sweep.map_ended = std::chrono::steady_clock::now();
      return placement;
    } catch (...) {
      map_error_ = std::current_exception();
      throw;
    }
  }

  void begin_map() {
    if (mapper_) {
      return;
    }
    mapper_.emplace(*context_, odometry_.config(), *map_, session_, map_memory_, earlier_sessions_,
                    start_);
    for (ForMap& measured : std::exchange(before_map_measured_, {})) {
      if (auto* fix = std::get_if<Mounted<GnssFix>>(&measured)) {
        fix->mounting = antenna();  // its transform may have come since
      } else {
        std::get<Mounted<Heading>>(measured).mounting = heading_axis();
      }
      map_fix(measured);  // the worker has nothing to do yet
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
    const std::string& imu = frame_of<ImuSample>();
    const std::string& lidar = frame_of<Sweep>();
    const bool named = !imu.empty() && !lidar.empty();
    const auto found = named ? transforms_.transform(imu, lidar) : std::nullopt;
    // By its numbers, so that the same setting gives the same bytes.
    return found ? Mounting{.source = MountingSource::transforms,
                            .T_imu_lidar = pose_of(numbers_of(*found)),
                            .conflict = transforms_.conflict(imu, lidar)}
                 : Mounting{.source = MountingSource::assumed};
  }

  std::optional<std::array<double, 7>> configured_;
  GnssConfig gnss_;
  ReceiverMounts mounts_;
  VelocityConfig velocity_;
  bool inertial_;
  MeasurementGate gate_;
  SensorFeed feed_;
  Odometry odometry_;
  engine::Context* context_;
  MapStore* map_;
  SessionId session_;
  MapMemory map_memory_;
  EarlierSessions earlier_sessions_;
  std::optional<StartPlace> start_;
  bool map_beside_;
  std::size_t most_behind_;
  std::function<void(const Sweep&, const SweepResult&)> placed_;
  Waits waits_;
  std::optional<Mapper> mapper_;
  std::vector<SweepResult> before_map_;  ///< results of sweeps before the odometry began
  std::vector<ForMap> before_map_measured_;
  std::optional<HighRateStream> high_rate_;
  std::deque<Result> results_;                           ///< not asked for yet, in their order
  std::deque<std::shared_future<MapPlacement>> behind_;  ///< sweeps that the map may work on
  std::future<void> last_fix_;  ///< that the map may work on; those before it are done before it
  bool flushing_ = false;
  bool failed_ = false;             ///< the last of results_ is a failure
  std::exception_ptr map_error_;    ///< the worker's: to be read once that was waited for
  std::exception_ptr map_failure_;  ///< the same, as it was seen in the results
  bool map_error_told_ = false;
  FrameTree transforms_;
  /// Of the first measurement of each kind that names one, in the order of Measurement.
  std::array<std::string, std::variant_size_v<Measurement>> frames_;
  bool has_readings_ = false;         ///< of the inertial sensor, used or not yet
  bool velocity_is_mounted_ = false;  ///< by a transform
  bool transforms_are_new_ = false;   ///< since the mounting was looked up
  std::optional<Mounting> mounting_;
  std::optional<Nanoseconds> last_sweep_;  ///< its stamp
  Worker worker_;                          ///< last: it uses the others
};

}  // namespace

std::unique_ptr<Slam> make_slam(engine::Context& context, const Config& config,
                                const SlamOptions& options) {
  return std::make_unique<OfflineSlam>(context, config, options);
}

}  // namespace adit
