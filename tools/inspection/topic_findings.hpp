// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// Collects what is found in one topic.
class TopicFindings {
 public:
  TopicFindings(const Topic& topic, std::vector<Finding>& findings)
      : topic_(&topic), findings_(&findings) {}

  void problem(std::string kind, std::string found, std::string effect, std::string remedy) {
    add(Severity::problem, std::move(kind), std::move(found), std::move(effect), std::move(remedy));
  }
  void notice(std::string kind, std::string found, std::string effect, std::string remedy) {
    add(Severity::notice, std::move(kind), std::move(found), std::move(effect), std::move(remedy));
  }
  /// A fault that `adit run` makes up for.
  void handled(std::string kind, std::string found, const std::string& how) {
    add(Severity::notice, std::move(kind), std::move(found), "handled automatically: " + how,
        "Nothing need be done");
  }
  /// Measurements that are left out: a fault where they are more than a few.
  void left_out(const char* kind, uint64_t part, uint64_t whole, const std::string& found,
                const char* remedy) {
    // Readings left out one by one leave gaps of two periods, far below imu.max_gap.
    constexpr double kFewLeftOut = 0.01;
    if (static_cast<double>(part) <= kFewLeftOut * static_cast<double>(whole)) {
      handled(kind, found, "they are left out");
    } else {
      problem(kind, found, "they are left out", remedy);
    }
  }

 private:
  void add(Severity severity, std::string kind, std::string found, std::string effect,
           std::string remedy) {
    findings_->push_back({severity, std::move(kind), topic_->name, std::move(found),
                          std::move(effect), std::move(remedy)});
  }

  const Topic* topic_;
  std::vector<Finding>* findings_;
};

}  // namespace adit
