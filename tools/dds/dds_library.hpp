// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "adit/tools/dds/dds_node.hpp"

namespace adit {

/// ROS_AUTOMATIC_DISCOVERY_RANGE where other machines are to be seen.
inline constexpr std::string_view kSubnetRange = "SUBNET";

/// Where the plug-in is looked for: ADIT_DDS_PLUGIN if that is set; else beside the program, and in
/// ../lib/adit of its folder.
std::vector<std::filesystem::path> dds_plugin_places();

/// Opens the plug-in and a node in it. Throws std::runtime_error where there is no plug-in (with
/// how to get it) or no node.
std::unique_ptr<DdsNode> open_dds_node(const DdsOptions& options);

/// The options that ROS's environment variables ask for: ROS_DOMAIN_ID, and for more than this
/// machine ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET or ROS_LOCALHOST_ONLY=0. Throws UsageError where a
/// number is none.
DdsOptions dds_options_of_environment();

}  // namespace adit
