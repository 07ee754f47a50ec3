// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Options that several commands have.
#pragma once

#include <cstdint>
#include <string>

#include "adit/tools/run/map_use.hpp"
#include "adit/tools/run/served_page.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

/// Adds --device, --max-vram and --validation.
void add_device_options(Command command, DeviceOptions& device);

/// Adds --max-ram.
void add_max_ram_option(Command command, uint64_t& bytes);
void add_map_use_options(Command command, MapUseOptions& use);

/// Adds --config and --set.
void add_config_options(Command command, ConfigSource& source);

/// Adds --metadata.
void add_metadata_option(Command command, ConfigSource& source);

/// Adds --port, --listen and --foxglove. `of` begins their descriptions where they belong to
/// another option.
void add_serve_options(Command command, ServeOptions& options, const std::string& of = {});

}  // namespace adit
