// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What has become of a run's GNSS fixes, for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "adit/slam/gnss/gnss_constraints.hpp"

namespace adit {

/// One line; where the map has no place in the world, why, and what to do about it.
std::string describe(const GnssReport& gnss);
/// Why it has none, and what to do about it: a clause.
std::string why_not_placed(const GnssReport& gnss);
/// When it was, how far, and what is on either side of it.
std::string describe(const ReceiverJump& jump);
/// One line on where the antenna really sits and how late its fixes are, with the settings that say
/// so; empty: nothing is known of it.
std::string describe_antenna(const GnssReport& gnss);
nlohmann::ordered_json to_json(const GnssReport& gnss);

/// One line on a run's headings: how many count, or why their source is refused; empty: none.
std::string describe(const HeadingReport& heading);
/// What is wrong with a source of headings, or why it does not count yet: a clause.
std::string why_not_used(const HeadingReport& heading);
/// The source is refused as a whole.
bool is_refused(const HeadingReport& heading);
nlohmann::ordered_json to_json(const HeadingReport& heading);

}  // namespace adit
