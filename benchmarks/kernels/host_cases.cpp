// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/host_vgicp.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/benchmarks/reference/deskew.hpp"
#include "adit/benchmarks/verify/registration_methods.hpp"
#include "adit/benchmarks/verify/verify.hpp"

namespace adit::bench {
namespace {

Work host_linearize(Bench& bench, int points) {
  const std::vector<gpu::uvec4>& cloud = bench.scene(points).source();
  const test::MethodCase method = test::method_case("", gpu::kVgicp, 1);
  const test::VoxelMapRun map = test::method_target(bench.context(), gpu::kVgicp, cloud);
  const reference::VoxelMap target = reference::decode(map.cells(), test::kMethodVoxel);
  const std::vector<reference::SurfacePoint> source = reference::decode(cloud);
  const Eigen::Isometry3d pose = retract(Eigen::Isometry3d::Identity(), test::offsets()[3].second);
  const auto host = std::make_shared<HostVgicp>(source, target, method.objective.d_max,
                                                std::thread::hardware_concurrency());
  const reference::System twin =
      reference::linearize(reference::find_matches(source, target, pose, method.objective.d_max));
  Work work{.verified_by = "double-precision twin", .items = cloud.size()};
  const double cost = host->linearize(pose)[27];
  // Points at the border of a voxel may fall to the other side.
  if (!(std::abs(cost / twin.cost - 1.0) < 2e-3)) {
    work.problem = "the cost is not the twin's";
  }
  work.figures["threads"] = host->threads();
  work.run = [host, pose] { return time_on_host([&] { host->linearize(pose); }); };
  return work;
}

/// De-skewing of a sweep as the kernel does it, in plain float32.
struct HostDeskew {
  std::vector<Point> raw;
  std::vector<float> times;
  std::vector<gpu::DeskewKnot> knots;
  engine::DeskewSettings settings;
  std::vector<Point> moved{};

  Point at_start(const Point& raw_point, float time) const {
    const Eigen::Vector3f p(raw_point.x, raw_point.y, raw_point.z);
    const float squared = p.squaredNorm();
    const auto low = static_cast<float>(settings.c_min);
    const auto high = static_cast<float>(settings.c_max);
    if (!(squared >= low * low && squared <= high * high) || !std::isfinite(time)) {
      return {0.0F, 0.0F, 0.0F, raw_point.intensity};
    }
    const auto last = static_cast<float>(knots.size() - 1);
    const auto first_time = static_cast<float>(settings.first_time);
    const auto span = static_cast<float>(settings.last_time) - first_time;
    const float place = std::clamp((time - first_time) / span * last, 0.0F, last);
    const std::size_t k = std::min(static_cast<std::size_t>(place), knots.size() - 2);
    const float share = place - static_cast<float>(k);
    const auto between = [share](const gpu::vec4& a, const gpu::vec4& b) {
      return Eigen::Vector4f((1.0F - share) * Eigen::Vector4f(a.x, a.y, a.z, a.w) +
                             share * Eigen::Vector4f(b.x, b.y, b.z, b.w));
    };
    const Eigen::Vector4f q = between(knots[k].rotation, knots[k + 1].rotation).normalized();
    const Eigen::Vector4f t = between(knots[k].translation, knots[k + 1].translation);
    const Eigen::Vector3f turn = 2.0F * q.head<3>().cross(p);
    const Eigen::Vector3f at = p + q.w() * turn + q.head<3>().cross(turn) + t.head<3>();
    return {at.x(), at.y(), at.z(), raw_point.intensity};
  }

  /// A thread a core, started anew.
  void run() {
    moved.resize(raw.size());
    const std::size_t parts = std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (std::size_t part = 0; part < parts; ++part) {
      threads.emplace_back([this, part, parts] {
        for (std::size_t i = raw.size() * part / parts; i < raw.size() * (part + 1) / parts; ++i) {
          moved[i] = at_start(raw[i], times[i]);
        }
      });
    }
  }
};

Work host_deskew(Bench& bench, int points) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const SweepMotion motion = test::sweep_motions().back();
  const auto host = std::make_shared<HostDeskew>(
      HostDeskew{.raw = scene.source,
                 .times = test::spread_times(scene.source.size(), motion),
                 .knots = knots(motion),
                 .settings = test::deskew_settings(motion, scene.preprocess.c_min)});
  host->run();
  const test::Verdict verdict = test::verify_deskew(
      host->raw, reference::deskew(host->raw, host->times, motion.T_start_lidar, host->settings),
      host->moved);
  Work work{.problem = verdict.passed() ? "" : verdict.problems.front(),
            .verified_by = "double-precision twin",
            .items = host->raw.size()};
  work.run = [host] { return time_on_host([&] { host->run(); }); };
  return work;
}

}  // namespace

std::vector<Case> host_cases() {
  return {{.name = "host/deskew", .kind = CaseKind::peer, .make = host_deskew},
          {.name = "host/linearize", .kind = CaseKind::peer, .make = host_linearize}};
}

}  // namespace adit::bench
