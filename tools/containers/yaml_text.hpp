// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The part of YAML that programs write: block mappings and sequences, plain, quoted and block
// scalars, flow sequences of scalars and of such sequences. No anchors; tags of types are ignored.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace adit {

/// A scalar, a mapping or a sequence.
struct YamlNode {
  std::string scalar{};                                    ///< empty for the others
  std::vector<std::pair<std::string, YamlNode>> fields{};  ///< of a mapping
  std::vector<YamlNode> items{};                           ///< of a sequence

  /// The value of a mapping's key; null where there is none.
  const YamlNode* find(std::string_view key) const;
};

/// The document; nothing where it is not understood.
std::optional<YamlNode> parse_yaml(std::string_view text);

}  // namespace adit
