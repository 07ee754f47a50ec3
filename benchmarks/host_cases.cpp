// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <thread>

#include "benchmarks/cases.hpp"
#include "benchmarks/host_vgicp.hpp"
#include "benchmarks/inputs.hpp"
#include "benchmarks/timing.hpp"
#include "tests/kernels/registration_methods.hpp"

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

}  // namespace

std::vector<Case> host_cases() {
  return {{.name = "host/linearize", .kind = CaseKind::peer, .make = host_linearize}};
}

}  // namespace adit::bench
