// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/solver.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <span>
#include <tuple>

#include <ceres/ceres.h>
#include <glog/logging.h>

#include "adit/slam/graph/graph_residuals.hpp"

// There where the BLAS that CHOLMOD calls is OpenBLAS, whose results depend on its threads.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));

namespace adit {
namespace {

// A node is a block of position and quaternion (x, y, z, qx, qy, qz, qw). Cost functions write
// their Jacobians by the tangent vector into the first columns of the block's, which the manifold's
// Jacobian of ones and zeros hands on: legal since every cost function here does so.
constexpr int kBlock = 7;
using Block = std::array<double, kBlock>;

Eigen::Isometry3d to_pose(const double* block) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(block);
  pose.linear() = Eigen::Map<const Eigen::Quaterniond>(block + 3).normalized().toRotationMatrix();
  return pose;
}

/// The decoupled retraction of lie.hpp. kFreedom 3: of (x, y, yaw) in the plane.
template <int kFreedom>
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kBlock; }
  int TangentSize() const override { return kFreedom; }

  bool Plus(const double* x, const double* delta, double* moved) const override {
    const Block result = numbers_of(retract(to_pose(x), lifted<kFreedom>(delta)));
    std::ranges::copy(result, moved);
    return true;
  }

  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kBlock, kFreedom, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }

  bool Minus(const double* y, const double* x, double* delta) const override {
    const Eigen::Isometry3d relative = to_pose(x).inverse() * to_pose(y);
    Vector6d xi;
    xi << relative.translation(), so3_log(relative.linear());
    Eigen::Map<Eigen::Matrix<double, kFreedom, 1>>{delta} = chosen_rows<kFreedom>(xi);
    return true;
  }

  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kFreedom, kBlock, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

template <int kFreedom>
class BetweenCost final : public ceres::SizedCostFunction<kFreedom, kBlock, kBlock> {
 public:
  BetweenCost(const PoseEdge& edge, ResidualConvention convention) : residual_(edge, convention) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const override {
    const Eigen::Isometry3d first = to_pose(blocks[0]);
    const Eigen::Isometry3d second = to_pose(blocks[1]);
    const bool wanted = jacobians != nullptr;
    const WhitenedEdge<kFreedom> edge = residual_.linearized(first, second, wanted);
    Eigen::Map<Eigen::Matrix<double, kFreedom, 1>>{residual} = edge.residual;
    if (wanted) {
      write(edge.by_first, jacobians[0]);
      write(edge.by_second, jacobians[1]);
    }
    return edge.residual.allFinite();
  }

 private:
  static void write(const Eigen::Matrix<double, kFreedom, kFreedom>& by_node, double* jacobian) {
    if (jacobian != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kFreedom, kBlock, Eigen::RowMajor>> whole(jacobian);
      whole.setZero();
      whole.template leftCols<kFreedom>() = by_node;
    }
  }

  EdgeResidual<kFreedom> residual_;
};

/// A residual between T_world_map and a node.
template <class Residual>
class TieCost final : public ceres::SizedCostFunction<Residual::kRows, kBlock, kBlock> {
 public:
  explicit TieCost(const Residual& residual) : residual_(residual) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const override {
    const auto tie = residual_.linearized(to_pose(blocks[0]), to_pose(blocks[1]));
    Eigen::Map<Eigen::Matrix<double, kRows, 1>>{residual} = tie.residual;
    if (jacobians != nullptr) {
      write(tie.by_world, jacobians[0]);
      write(tie.by_node, jacobians[1]);
    }
    return tie.residual.allFinite();
  }

 private:
  static constexpr int kRows = Residual::kRows;
  static void write(const Eigen::Matrix<double, kRows, 6>& by_pose, double* jacobian) {
    if (jacobian != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kRows, kBlock, Eigen::RowMajor>> whole(jacobian);
      whole.setZero();
      whole.template leftCols<6>() = by_pose;
    }
  }

  Residual residual_;
};

/// Holds T_world_map near its start in what neither fixes nor levels determine. Headings place a
/// map that a straight way has not levelled yet, and fixes along a line leave its roll about that
/// free: with them the tilt is held to what an upright map has at the start of a run.
class WorldPrior final : public ceres::SizedCostFunction<6, kBlock> {
 public:
  WorldPrior(const Eigen::Isometry3d& start, bool upright) : start_(start), upright_(upright) {}

  bool Evaluate(const double* const* blocks, double* residual, double** jacobians) const override {
    constexpr double kPosition = 1e-4;     // 1/m: ten kilometres count as one
    constexpr double kRotation = 1e-2;     // 1/rad
    constexpr double kUprightRoot = 10.0;  // 1/rad: ten times what rough gravity is off by
    Vector6d root;
    root << Eigen::Vector3d::Constant(kPosition), Eigen::Vector3d::Constant(kRotation);
    if (upright_) {
      root.segment<2>(3).setConstant(kUprightRoot);
    }
    const Eigen::Isometry3d moved = start_.inverse() * to_pose(blocks[0]);
    const BetweenResidual between = between_residual(moved, ResidualConvention::rotation);
    Eigen::Map<Vector6d>{residual} = root.cwiseProduct(between.residual);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 6, kBlock, Eigen::RowMajor>> whole(jacobians[0]);
      whole.setZero();
      whole.leftCols<6>() = root.asDiagonal() * between.by_error;
    }
    return true;
  }

 private:
  Eigen::Isometry3d start_;
  bool upright_;
};

class KernelLoss final : public ceres::LossFunction {
 public:
  explicit KernelLoss(const RobustLoss& kernel) : kernel_(kernel) {}

  void Evaluate(double squared, double result[3]) const override {
    const KernelValue value = apply(kernel_, squared);
    result[0] = value.cost;
    result[1] = value.weight;
    result[2] = value.curvature;
  }

 private:
  RobustLoss kernel_;
};

/// Hands iterations on, and ends the solver where the caller wants it or its steps lead nowhere.
class Watch final : public ceres::IterationCallback {
 public:
  Watch(const OptimizationSettings& settings, bool cautious)
      : settings_(settings), cautious_(cautious) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
    const bool rose = step.iteration > 0 && !step.step_is_successful;
    rises_ = rose ? rises_ + 1 : 0;
    if (settings_.on_step && !settings_.on_step({step.iteration, 2.0 * step.cost})) {
      stopped_ = true;
      return ceres::SOLVER_ABORT;
    }
    astray_ = !cautious_ && rises_ >= 2;
    return astray_ ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

  bool stopped() const { return stopped_; }
  bool astray() const { return astray_; }

 private:
  const OptimizationSettings& settings_;
  bool cautious_;
  int rises_ = 0;  ///< in a row
  bool stopped_ = false;
  bool astray_ = false;
};

/// The active edges in an order that does not depend on the one in which they were added.
std::vector<std::size_t> canonical_order(const PoseGraph& graph) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (graph.edges()[i].status == EdgeStatus::active) {
      order.push_back(i);
    }
  }
  const auto parts_of = [](const PoseEdge& edge) {
    return std::pair(std::span(edge.T_from_to.data(), 16), std::span(edge.information.data(), 36));
  };
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) {
    const PoseEdge& a = graph.edges()[i];
    const PoseEdge& b = graph.edges()[j];
    const auto key = [](const PoseEdge& e) { return std::tuple(e.from, e.to, e.kind); };
    if (key(a) != key(b)) {
      return key(a) < key(b);
    }
    const auto [pose_a, information_a] = parts_of(a);
    const auto [pose_b, information_b] = parts_of(b);
    return !std::ranges::equal(pose_a, pose_b)
               ? std::ranges::lexicographical_compare(pose_a, pose_b)
               : std::ranges::lexicographical_compare(information_a, information_b);
  });
  return order;
}

/// The fixes, likewise.
std::vector<PositionFix> canonical_fixes(const PoseGraph& graph) {
  std::vector<PositionFix> fixes = graph.fixes();
  const auto key = [](const PositionFix& fix) {
    return std::tuple(fix.node, fix.p_world.x(), fix.p_world.y(), fix.p_world.z(),
                      fix.information(0, 0));
  };
  std::ranges::stable_sort(fixes, {}, key);
  return fixes;
}

/// The headings, likewise.
std::vector<MeasuredHeading> canonical_headings(const PoseGraph& graph) {
  std::vector<MeasuredHeading> headings = graph.headings();
  std::ranges::stable_sort(headings, {}, [](const MeasuredHeading& heading) {
    return std::tuple(heading.node, heading.yaw, heading.information);
  });
  return headings;
}

/// A graph as Ceres's problem, over blocks of its nodes.
template <int kFreedom>
class GraphProblem {
 public:
  GraphProblem(const PoseGraph& graph, const std::vector<NodeId>& held,
               const OptimizationSettings& settings)
      : odometry_loss_(settings.odometry_kernel),
        loop_loss_(settings.loop_kernel),
        world_(numbers_of(graph.T_world_map())),
        world_start_(world_),
        problem_(problem_options()) {
    blocks_.reserve(graph.nodes().size());
    for (const PoseNode& node : graph.nodes()) {
      blocks_.push_back(numbers_of(node.T_map_node));
    }
    const std::vector<std::size_t> order = canonical_order(graph);
    std::vector<bool> tied(blocks_.size());
    for (const std::size_t i : order) {
      const PoseEdge& edge = graph.edges()[i];
      tied[graph.index_of(edge.from)] = true;
      tied[graph.index_of(edge.to)] = true;
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (tied[i]) {
        problem_.AddParameterBlock(blocks_[i].data(), kBlock, &manifold_);
        if (graph.nodes()[i].fixed || std::ranges::binary_search(held, graph.nodes()[i].id)) {
          problem_.SetParameterBlockConstant(blocks_[i].data());
        }
      }
    }
    for (const std::size_t i : order) {
      const PoseEdge& edge = graph.edges()[i];
      problem_.AddResidualBlock(new BetweenCost<kFreedom>(edge, settings.convention),
                                loss(edge, settings), blocks_[graph.index_of(edge.from)].data(),
                                blocks_[graph.index_of(edge.to)].data());
    }
    if constexpr (kFreedom == 6) {
      tie_to_world(graph, tied);
    }
    start_ = blocks_;
  }

  ceres::Problem& problem() { return problem_; }
  void return_to_start() {  // in place: Ceres knows the blocks by their address
    blocks_ = start_;
    world_ = world_start_;
  }
  Eigen::Isometry3d T_world_map(const PoseGraph& graph) const {
    return world_ == world_start_ ? graph.T_world_map() : to_pose(world_.data());
  }
  /// The graph's own where a node has not moved: a quaternion would change their last digits.
  std::vector<Eigen::Isometry3d> poses(const PoseGraph& graph) const {
    std::vector<Eigen::Isometry3d> result = poses_of(graph);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      if (blocks_[i] != start_[i]) {
        result[i] = to_pose(blocks_[i].data());
      }
    }
    return result;
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }

  /// What no edge ties has no part in the graph's shape, and its fixes none in where that lies.
  void tie_to_world(const PoseGraph& graph, const std::vector<bool>& tied) {
    bool any = false;
    const auto add = [&](NodeId node, ceres::CostFunction* cost) {
      if (!any) {
        problem_.AddParameterBlock(world_.data(), kBlock, &manifold_);
        problem_.AddResidualBlock(new WorldPrior(graph.T_world_map(), !graph.headings().empty()),
                                  nullptr, world_.data());
        any = true;
      }
      problem_.AddResidualBlock(cost, nullptr, world_.data(), blocks_[graph.index_of(node)].data());
    };
    for (const PositionFix& fix : canonical_fixes(graph)) {
      if (tied[graph.index_of(fix.node)]) {
        add(fix.node, new TieCost<FixResidual>(FixResidual(fix)));
      }
    }
    for (const LevelledNode& level : graph.levels()) {
      if (tied[graph.index_of(level.node)]) {
        add(level.node, new TieCost<LevelResidual>(LevelResidual(level)));
      }
    }
    for (const MeasuredHeading& heading : canonical_headings(graph)) {
      if (tied[graph.index_of(heading.node)]) {
        add(heading.node, new TieCost<HeadingResidual>(HeadingResidual(heading)));
      }
    }
  }

  ceres::LossFunction* loss(const PoseEdge& edge, const OptimizationSettings& settings) {
    const bool loop = edge.kind == EdgeKind::loop;
    const RobustLoss& kernel = loop ? settings.loop_kernel : settings.odometry_kernel;
    return kernel.kernel == Kernel::none ? nullptr : loop ? &loop_loss_ : &odometry_loss_;
  }

  PoseManifold<kFreedom> manifold_;
  KernelLoss odometry_loss_;
  KernelLoss loop_loss_;
  std::vector<Block> blocks_;
  std::vector<Block> start_;
  Block world_;
  Block world_start_;
  ceres::Problem problem_;
};

ceres::Solver::Options solver_options(const OptimizationSettings& settings, double radius) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
#ifdef CERES_NO_SUITESPARSE
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
#else
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
#endif
  options.initial_trust_region_radius = radius;
  options.max_trust_region_radius = 1e32;
  options.max_num_iterations = settings.max_iterations;
  options.function_tolerance = settings.cost_tolerance;
  options.parameter_tolerance = 1e-14;
  options.max_solver_time_in_seconds = 1e18;  // time decides nothing
  options.num_threads = 1;
  options.minimizer_progress_to_stdout = false;
  options.logging_type = ceres::SILENT;
  return options;
}

Termination termination_of(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE:
    case ceres::USER_SUCCESS:
      return Termination::converged;
    case ceres::NO_CONVERGENCE:
      return Termination::iteration_limit;
    default:
      return Termination::failed;
  }
}

template <int kFreedom>
void solve(const PoseGraph& graph, const OptimizationSettings& settings, OptimizedGraph& result) {
  OptimizationReport& report = result.report;
  GraphProblem<kFreedom> problem(graph, report.held, settings);
  for (const bool cautious : {false, true}) {
    Watch watch(settings, cautious);
    ceres::Solver::Options options =
        solver_options(settings, cautious ? settings.cautious_radius : settings.initial_radius);
    options.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem.problem(), &summary);
    report.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
    report.termination = watch.stopped() ? Termination::stopped : termination_of(summary);
    report.message = summary.message;
    if (!watch.astray() && report.termination != Termination::failed) {
      break;
    }
    if (!cautious) {
      report.restarted = true;
      problem.return_to_start();
    }
  }
  result.poses = problem.poses(graph);
  result.T_world_map = problem.T_world_map(graph);
}

bool can_move(const PoseGraph& graph, const std::vector<NodeId>& held) {
  const auto moves = [&](NodeId id) {
    return !graph.nodes()[graph.index_of(id)].fixed && !std::ranges::binary_search(held, id);
  };
  return std::ranges::any_of(graph.edges(), [&](const PoseEdge& edge) {
    return edge.status == EdgeStatus::active && (moves(edge.from) || moves(edge.to));
  });
}

}  // namespace

OptimizedGraph optimize(const PoseGraph& graph, const OptimizationSettings& settings) {
  // What Ceres has to say comes back in its summary; glog would print it.
  FLAGS_minloglevel = google::GLOG_FATAL;
  if (openblas_set_num_threads != nullptr) {
    openblas_set_num_threads(1);
  }
  const auto start = std::chrono::steady_clock::now();
  OptimizedGraph result;
  OptimizationReport& report = result.report;
  report.components = connected_components(graph);
  report.held = nodes_to_hold(report.components);
  report.cost_before = graph_cost(graph, settings);
  result.poses = poses_of(graph);
  result.T_world_map = graph.T_world_map();
  if (can_move(graph, report.held)) {
    if (graph.planar()) {
      solve<3>(graph, settings, result);
    } else {
      solve<6>(graph, settings, result);
    }
  }
  report.edges = edge_results(graph, result.poses, settings);
  report.cost_after = cost_of(graph, result, settings);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace adit
