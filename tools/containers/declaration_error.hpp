// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "adit/tools/support/input_error.hpp"

namespace adit {

/// A container does not hold what it declares. What it holds can be read.
class DeclarationError : public InputError {
 public:
  /// `topic`: the one that it is about; empty: not a single one. `missing`: number of messages that
  /// are lost; none: some are, and nothing tells how many.
  DeclarationError(const std::filesystem::path& file, std::string found, std::string remedy,
                   std::string topic = {}, std::optional<uint64_t> missing = 0)
      : InputError(file, {}, std::move(found), std::move(remedy)),
        topic_(std::move(topic)),
        missing_(missing),
        loses_(missing != 0U) {}

  /// The same where another error counts the messages that are lost.
  DeclarationError counted_elsewhere() && {
    missing_ = 0;
    return std::move(*this);
  }

  const std::string& topic() const { return topic_; }
  const std::optional<uint64_t>& missing() const { return missing_; }
  /// False where all that is there can be read, and no message is known to be lost.
  bool loses() const { return loses_; }

 private:
  std::string topic_;
  std::optional<uint64_t> missing_;
  bool loses_ = false;
};

/// `what` declares a number of messages on a topic, and `found` can be read.
DeclarationError wrong_count(const std::filesystem::path& file, const std::string& what,
                             const std::string& topic, uint64_t declared, uint64_t found);

}  // namespace adit
