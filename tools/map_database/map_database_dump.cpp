// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map's content as text.
#include <array>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

/// Numbers after a word, as the shortest text that reads back to the same doubles.
template <class Numbers>
void append_all(std::string& line, const std::string& word, const Numbers& numbers) {
  line += " " + word;
  for (const double number : numbers) {
    line += ' ';
    append_number(line, number);
  }
}

/// FNV-1a, to compare chunks by.
uint64_t hash(std::span<const std::byte> bytes) {
  uint64_t value = 0xcbf29ce484222325U;
  for (const std::byte byte : bytes) {
    value = (value ^ static_cast<uint64_t>(byte)) * 0x100000001b3U;
  }
  return value;
}

/// A text of the map on one line.
std::string in_one_line(const std::string& text) {
  std::string line;
  for (const char letter : text) {
    line += letter == '\n' ? std::string("\\n") : letter == '\\' ? "\\\\" : std::string(1, letter);
  }
  return line;
}

}  // namespace

void MapDatabase::dump(const std::function<void(std::string_view)>& line) const {
  for (const MapSession& session : sessions()) {
    const std::string head = "session " + std::to_string(session.id);
    line(head + " name " + in_one_line(session.name));
    line(head + " configuration " + in_one_line(session.configuration));
    for (const auto& [key, value] : session.provenance) {
      line(head + " " + in_one_line(key) + " = " + in_one_line(value));
    }
  }
  for (const auto& [session, anchor] : anchors()) {
    std::string text = "anchor of session " + std::to_string(session);
    append_all(text, "pose", pose_numbers(anchor));
    line(text);
  }
  for (const MapKeyframe& keyframe : keyframes()) {
    std::string text = "keyframe " + std::to_string(keyframe.id) + " session " +
                       std::to_string(keyframe.session) + " stamp ";
    append_stamp(text, keyframe.stamp);
    text += keyframe.fixed ? " fixed" : "";
    append_all(text, "pose", pose_numbers(keyframe.T_map_keyframe));
    append_all(text, "covariance", matrix_numbers(keyframe.covariance));
    line(text + " vertical " + std::string(to_string(keyframe.vertical)));
    const MapSubmap content = submap(keyframe.id);
    text = "submap " + std::to_string(keyframe.id);
    append_all(text, "lower", std::vector<double>(content.lower.begin(), content.lower.end()));
    append_all(text, "upper", std::vector<double>(content.upper.begin(), content.upper.end()));
    for (const std::vector<std::byte>& chunk : content.chunks) {
      text += " chunk " + std::to_string(chunk.size()) + " bytes " + std::to_string(hash(chunk));
    }
    line(text);
  }
  std::size_t number = 0;
  for (const PoseEdge& edge : edges()) {
    std::string text = "edge " + std::to_string(number++) + " from " + std::to_string(edge.from) +
                       " to " + std::to_string(edge.to) + " " + std::string(to_string(edge.kind));
    text += edge.status == EdgeStatus::active      ? " active"
            : edge.status == EdgeStatus::candidate ? " candidate"
                                                   : " revoked";
    append_all(text, "pose", pose_numbers(edge.T_from_to));
    append_all(text, "information", matrix_numbers(edge.information));
    line(text);
  }
  for (const LoopCandidate& candidate : candidates()) {
    std::string text = "candidate " + std::to_string(candidate.id) + " from " +
                       std::to_string(candidate.from) + " to " + std::to_string(candidate.to) +
                       " verdict " + std::to_string(static_cast<int>(candidate.verdict)) + " by " +
                       std::string(to_string(candidate.source));
    append_all(text, "score", std::array{candidate.score, candidate.overlap, candidate.chi2});
    append_all(text, "figures",
               std::array{candidate.rms, candidate.correction, candidate.turn, candidate.through,
                          candidate.figure});
    append_all(text, "pose", pose_numbers(candidate.T_from_to));
    line(text + " reason " + in_one_line(candidate.reason));
  }
  for (const MapFix& fix : fixes()) {
    std::string text =
        "fix " + std::to_string(fix.id) + " keyframe " + std::to_string(fix.keyframe) + " stamp ";
    append_stamp(text, fix.stamp);
    text += " kind " + std::to_string(static_cast<int>(fix.kind));
    append_all(text, "place",
               std::array{fix.place.latitude, fix.place.longitude, fix.place.altitude});
    append_all(text, "covariance", square_numbers(fix.covariance));
    append_all(text, "antenna", vector_numbers(fix.p_keyframe_antenna));
    append_all(text, "figures", std::array{fix.path, fix.chi2});
    append_all(text, "information", square_numbers(fix.information));
    line(text + " verdict " + std::string(to_string(fix.verdict)));
  }
  for (const MapHeading& heading : headings()) {
    std::string text = "heading keyframe " + std::to_string(heading.keyframe) + " stamp ";
    append_stamp(text, heading.stamp);
    append_all(text, "yaw", std::array{heading.yaw, heading.sigma, heading.information});
    append_all(text, "axis", vector_numbers(heading.axis_keyframe));
    line(text);
  }
  for (const ControlPoint& point : control_points()) {
    std::string text = "control " + in_one_line(point.name) + " role " +
                       std::string(to_string(point.role)) + " keyframe " +
                       std::to_string(point.keyframe);
    append_all(text, "point", vector_numbers(point.p_keyframe));
    append_all(text, "marked", vector_numbers(point.p_marked));
    append_all(text, "place",
               std::array{point.place.latitude, point.place.longitude, point.place.altitude});
    append_all(text, "sigma", vector_numbers(point.sigma));
    line(text);
  }
  if (const std::optional<Georeference> world = georeference()) {
    std::string text = "georeference";
    append_all(text, "origin",
               std::array{world->origin.latitude, world->origin.longitude, world->origin.altitude});
    append_all(text, "pose", pose_numbers(world->T_world_map));
    append_all(text, "covariance", matrix_numbers(world->covariance));
    line(text);
  }
}

}  // namespace adit
