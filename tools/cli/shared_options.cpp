// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cli/shared_options.hpp"

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/setup/presets.hpp"

namespace adit {
namespace {

constexpr double kLastPort = 65535;

}  // namespace

void add_device_options(Command command, DeviceOptions& device) {
  command.option("--device", device.device, "Index, UUID or part of the name, see `adit devices`")
      .value_name("DEVICE");
  command
      .option("--max-vram", device.max_vram_bytes,
              "Most device memory to use, e.g. 512MiB; where more is needed: exit 1")
      .bytes()
      .value_name("SIZE");
  command.flag("--validation", device.validation,
               "Check every Vulkan call and barrier (slow); a complaint is a failure");
}

void add_map_use_options(Command command, MapUseOptions& use) {
  command
      .option("--map", use.map,
              "Localise the run in this earlier map, which stays as it is, or with --extend go on "
              "with it")
      .value_name("MAP");
  command.flag("--localize", use.localize, "With --map, and what it does by itself");
  command.flag("--extend", use.extend,
               "With --map: OUT/map.adit is a copy of it that the run extends");
  command.flag("--keep", use.keep, "With --extend: keyframes of the earlier map stay in place");
  command
      .option(
          "--pose", use.pose,
          "With --map: about where the lidar is in it at first, within some 2 m and 10 degrees; "
          "metres and degrees")
      .values(4, 4)
      .value_name("X Y Z YAW");
}

void add_max_ram_option(Command command, uint64_t& bytes) {
  command
      .option("--max-ram", bytes,
              "Most memory to be resident, a software device's included, e.g. 1GiB; below what is "
              "needed: exit 2")
      .bytes()
      .value_name("SIZE");
}

void add_config_options(Command command, ConfigSource& source) {
  command.option("--config", source.file, "TOML file; `adit config` prints one with every setting")
      .value_name("FILE");
  std::string known;
  for (const std::string& name : preset_names()) {
    known += (known.empty() ? "" : ", ") + name;
  }
  command.option("--preset", source.preset, "Settings for a public data set: " + known)
      .value_name("NAME")
      .suggest(preset_names());
  command.option("--set", source.overrides, "Overrides one setting; may be given several times")
      .value_name("SECTION.KEY=VALUE")
      .one_value_each();
}

void add_metadata_option(Command command, ConfigSource& source) {
  command
      .option("--metadata", source.metadata,
              "A file about the sensor whose packets are recorded: Ouster's JSON, Hesai's "
              "angle correction (CSV)")
      .value_name("FILE");
}

void add_serve_options(Command command, ServeOptions& options, const std::string& of) {
  command.option("--port", options.port, of + "Port; 0 takes any that is free")
      .value_name("N")
      .from(0, kLastPort)
      .show_default();
  command.option("--listen", options.listen, of + "Numeric address to listen on, or localhost")
      .value_name("ADDRESS")
      .show_default();
  command.flag("--foxglove", options.foxglove,
               of + "Print a link for Foxglove and Lichtblick; links carry a token then");
}

}  // namespace adit
