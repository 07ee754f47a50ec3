// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/g2o_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestLine = 31;          // words, of an EDGE_SE3:QUAT
constexpr double kLargestNumber = 1e15;           // beyond any position and information
constexpr double kLargestPosition = 1e9;          // m: rotations would lose their last digits
constexpr std::array<int, 3> kPlane = {0, 1, 5};  // x, y, yaw in [rho, phi]

using Words = std::span<const std::string_view>;

/// The nearest matrix without negative eigenvalues; nothing where they are none but for rounding.
std::optional<Matrix6d> without_negative_part(const Matrix6d& matrix) {
  if (Eigen::LLT<Matrix6d>(matrix).info() == Eigen::Success) {
    return std::nullopt;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(matrix);
  if (eigen.eigenvalues()(0) >= -1e-9 * matrix.cwiseAbs().maxCoeff()) {
    return std::nullopt;
  }
  const Matrix6d result = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                          eigen.eigenvectors().transpose();
  return 0.5 * (result + result.transpose());
}

class Parser {
 public:
  Parser(std::string_view text, std::filesystem::path file)
      : lines_(text), file_(std::move(file)) {}

  G2oFile parse() {
    std::array<std::string_view, kLongestLine> storage;
    while (const std::optional<std::string_view> line = lines_.next()) {
      const std::size_t count = split_words(without_comment(*line), storage);
      if (count > 0) {
        take(storage, count);
      }
    }
    return assembled();
  }

 private:
  template <class T>
  struct Placed {
    T value;
    uint64_t line = 0;
  };

  [[noreturn]] void fail(std::string found,
                         std::string remedy = "Correct or delete the line") const {
    fail_at(lines_.number(), std::move(found), std::move(remedy));
  }
  [[noreturn]] void fail_at(uint64_t line, std::string found, std::string remedy) const {
    throw InputError(file_, Place::line(line), std::move(found), std::move(remedy));
  }

  void take(std::span<const std::string_view> storage, std::size_t count) {
    const std::string_view tag = storage[0];
    const auto expect = [&](std::size_t wanted) {
      if (count != wanted) {
        fail("words after " + std::string(tag) + ": " + std::to_string(count - 1) + ", expected " +
             std::to_string(wanted - 1));
      }
      return storage.subspan(1, wanted - 1);
    };
    if (tag == "VERTEX_SE3:QUAT") {
      take_node(expect(9), false);
    } else if (tag == "VERTEX_SE2") {
      take_node(expect(5), true);
    } else if (tag == "EDGE_SE3:QUAT") {
      take_edge(expect(31), false);
    } else if (tag == "EDGE_SE2") {
      take_edge(expect(12), true);
    } else if (tag == "FIX") {
      if (count < 2 || count > storage.size()) {
        fail("FIX names " + std::to_string(count - 1) + " nodes, expected 1 to 30 a line");
      }
      for (const std::string_view word : storage.subspan(1, count - 1)) {
        fixed_.push_back({id(word), lines_.number()});
      }
    } else if (tag.starts_with("PARAMS_")) {
      ++parameter_lines_;
    } else {
      fail("the tag " + in_quotes(tag) + " is none that is read. " +
               suggestion(std::string(tag.substr(0, 40)),
                          {"VERTEX_SE3:QUAT", "EDGE_SE3:QUAT", "VERTEX_SE2", "EDGE_SE2", "FIX"}),
           "Graphs of poses alone can be optimised: no landmarks, no priors");
    }
  }

  NodeId id(std::string_view word) const {
    const std::optional<uint64_t> number = parse_unsigned(word);
    if (!number || *number > static_cast<uint64_t>(std::numeric_limits<NodeId>::max())) {
      fail("the id " + in_quotes(word) + " is no whole number from 0 up to 2^63 - 1");
    }
    return static_cast<NodeId>(*number);
  }

  double number(std::string_view word, double limit = kLargestNumber) const {
    const std::optional<double> value = parse_double(word);
    if (!value || !(std::abs(*value) <= limit)) {
      fail(in_quotes(word) + " is not a number of at most " +
           (limit == kLargestNumber ? "1e15" : "1e9"));
    }
    return *value;
  }

  void require_kind(bool planar) {
    if (planar_ && *planar_ != planar) {
      fail("SE(2) and SE(3) in one file: the lines before are " +
               std::string(planar ? "SE(3)" : "SE(2)"),
           "Split the file");
    }
    planar_ = planar;
  }

  Eigen::Isometry3d pose(Words words, bool planar) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = number(words[0], kLargestPosition);
    pose.translation().y() = number(words[1], kLargestPosition);
    if (planar) {
      const double yaw = number(words[2], kLargestPosition);
      pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      return pose;
    }
    pose.translation().z() = number(words[2], kLargestPosition);
    const Eigen::Quaterniond q(number(words[6]), number(words[3]), number(words[4]),
                               number(words[5]));
    if (!(q.norm() > 1e-3 && q.norm() < 1e3)) {
      fail("the quaternion (qx qy qz qw) has length " + std::to_string(q.norm()) + ", not 1");
    }
    pose.linear() = q.normalized().toRotationMatrix();
    return pose;
  }

  void take_node(Words words, bool planar) {
    require_kind(planar);
    nodes_.push_back(
        {{.id = id(words[0]), .T_map_node = pose(words.subspan(1), planar)}, lines_.number()});
  }

  void take_edge(Words words, bool planar) {
    require_kind(planar);
    PoseEdge edge;
    edge.from = id(words[0]);
    edge.to = id(words[1]);
    edge.T_from_to = pose(words.subspan(2), planar);
    edge.information.setZero();
    const int size = planar ? 3 : 6;
    std::size_t next = planar ? 5 : 9;
    for (int row = 0; row < size; ++row) {
      for (int column = row; column < size; ++column) {
        const int r = planar ? kPlane[static_cast<std::size_t>(row)] : row;
        const int c = planar ? kPlane[static_cast<std::size_t>(column)] : column;
        edge.information(r, c) = edge.information(c, r) = number(words[next++]);
      }
    }
    if (const std::optional<Matrix6d> positive = without_negative_part(edge.information)) {
      edge.information = *positive;
      indefinite_lines_.push_back(lines_.number());
    }
    const bool follows = edge.to - edge.from == 1 || edge.from - edge.to == 1;
    edge.kind = follows ? EdgeKind::odometry : EdgeKind::loop;
    edges_.push_back({edge, lines_.number()});
  }

  G2oFile assembled() {
    if (nodes_.empty()) {
      throw InputError(file_, {}, "it holds no vertex",
                       "Expected lines that begin with VERTEX_SE3:QUAT or VERTEX_SE2");
    }
    G2oFile result{
        PoseGraph(planar_.value_or(false)), {}, std::move(indefinite_lines_), parameter_lines_};
    // In the order of ids: a graph in another order would be sorted by insertion.
    std::ranges::stable_sort(nodes_, {},
                             [](const Placed<PoseNode>& node) { return node.value.id; });
    for (const Placed<PoseNode>& node : nodes_) {
      guarded(node.line, [&] { result.graph.add_node(node.value); });
    }
    for (const Placed<PoseEdge>& edge : edges_) {
      guarded(edge.line, [&] { result.graph.add_edge(edge.value); });
      result.edge_lines.push_back(edge.line);
    }
    for (const Placed<NodeId>& node : fixed_) {
      guarded(node.line, [&] { result.graph.set_fixed(node.value, true); });
    }
    return result;
  }

  template <class Action>
  void guarded(uint64_t line, const Action& action) const {
    try {
      action();
    } catch (const GraphError& error) {
      fail_at(line, error.what(), "Correct or delete the line");
    }
  }

  LineReader lines_;
  std::filesystem::path file_;
  std::optional<bool> planar_;
  std::vector<Placed<PoseNode>> nodes_;
  std::vector<Placed<PoseEdge>> edges_;
  std::vector<Placed<NodeId>> fixed_;
  std::vector<uint64_t> indefinite_lines_;
  std::size_t parameter_lines_ = 0;
};

void append(std::string& line, double value) {
  line += ' ';
  append_number(line, value);
}

void append_pose(std::string& line, const Eigen::Isometry3d& pose, bool planar) {
  const Eigen::Vector3d& p = pose.translation();
  append(line, p.x());
  append(line, p.y());
  if (planar) {
    append(line, std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)));
    return;
  }
  append(line, p.z());
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
    append(line, q.w() < 0.0 ? -value : value);
  }
}

}  // namespace

G2oFile parse_g2o(std::string_view text, const std::filesystem::path& file) {
  return Parser(text, file).parse();
}

G2oFile read_g2o(const std::filesystem::path& file) {
  return parse_g2o(read_text_file(file), file);
}

void write_g2o(const std::filesystem::path& file, const PoseGraph& graph) {
  const bool planar = graph.planar();
  OutputFile out(file);
  if (!graph.levels().empty() || !graph.fixes().empty()) {
    out.write("# without the verticals of " + std::to_string(graph.levels().size()) +
              " nodes and without " + std::to_string(graph.fixes().size()) +
              " GNSS fixes: the format has none\n");
  }
  for (const PoseNode& node : graph.nodes()) {
    std::string line = planar ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ";
    line += std::to_string(node.id);
    append_pose(line, node.T_map_node, planar);
    out.write(line + "\n");
  }
  for (const PoseNode& node : graph.nodes()) {
    if (node.fixed) {
      out.write("FIX " + std::to_string(node.id) + "\n");
    }
  }
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status != EdgeStatus::active) {
      continue;
    }
    std::string line = planar ? "EDGE_SE2 " : "EDGE_SE3:QUAT ";
    line += std::to_string(edge.from) + " " + std::to_string(edge.to);
    append_pose(line, edge.T_from_to, planar);
    for (int row = 0; row < (planar ? 3 : 6); ++row) {
      for (int column = row; column < (planar ? 3 : 6); ++column) {
        const int r = planar ? kPlane[static_cast<std::size_t>(row)] : row;
        const int c = planar ? kPlane[static_cast<std::size_t>(column)] : column;
        append(line, edge.information(r, c));
      }
    }
    out.write(line + "\n");
  }
  out.close();
}

}  // namespace adit
