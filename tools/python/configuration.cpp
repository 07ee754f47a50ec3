// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/python/configuration.hpp"

#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <nlohmann/json.hpp>

#include "adit/tools/python/pickling.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/presets.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::python {
namespace {

using Overrides = std::vector<std::string>;

/// A value as TOML has it.
std::string toml_of(const std::string& setting, const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) {
    return value.cast<bool>() ? "true" : "false";
  }
  if (py::isinstance<py::int_>(value)) {
    return py::str(value);
  }
  if (py::isinstance<py::str>(value)) {
    return nlohmann::json(value.cast<std::string>()).dump();
  }
  if (py::hasattr(value, "__fspath__")) {
    return nlohmann::json(value.attr("__fspath__")().cast<std::string>()).dump();
  }
  if (py::hasattr(value, "__float__") && !py::hasattr(value, "__len__")) {
    return py::repr(py::float_(py::reinterpret_borrow<py::object>(value)));
  }
  if (py::isinstance<py::sequence>(value) || py::hasattr(value, "tolist")) {
    std::string text;
    for (const py::handle one : value) {
      text += (text.empty() ? "" : ", ") + toml_of(setting, one);
    }
    return "[" + text + "]";
  }
  throw py::type_error(fmt::format("{}: a number, a text or a sequence of numbers, not {}", setting,
                                   std::string(py::repr(value))));
}

std::vector<std::string> names_in(const nlohmann::ordered_json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) {
    names.push_back(name);
  }
  return names;
}

/// For what is named without a value: load_config() checks what has one. Throws UsageError.
void require_known(const std::string& name) {
  const nlohmann::ordered_json known = to_json(Config{});
  const std::size_t dot = name.find('.');
  const std::string section = name.substr(0, dot);
  const auto found = known.find(section);
  if (found == known.end()) {
    throw UsageError(fmt::format("{}: there is no section '{}'. {}.", name, section,
                                 suggestion(section, names_in(known))));
  }
  if (dot == std::string::npos) {
    return;
  }
  const std::string key = name.substr(dot + 1);
  if (!found->contains(key)) {
    throw UsageError(fmt::format("{}: there is no setting '{}'. {}.", name, name,
                                 suggestion(key, names_in(*found), section + ".")));
  }
}

/// "section.key=value" of each setting in a dictionary; None: not given. Throws UsageError for
/// unknown names without a value.
void add_overrides(Overrides& overrides, const py::dict& settings, const std::string& prefix) {
  for (const auto& [key, value] : settings) {
    const std::string name = prefix + py::str(key).cast<std::string>();
    if (py::isinstance<py::dict>(value)) {
      require_known(name);
      add_overrides(overrides, py::reinterpret_borrow<py::dict>(value), name + ".");
    } else if (value.is_none()) {
      require_known(name);
    } else {
      overrides.push_back(name + "=" + toml_of(name, value));
    }
  }
}

/// Here nobody has written an option of the command line.
Config loaded(const ConfigSource& source) {
  try {
    return load_config(source);
  } catch (const UsageError& error) {
    const std::string text = error.what();
    constexpr std::string_view kOption = "--set ";
    throw UsageError(text.starts_with(kOption) ? text.substr(kOption.size()) : text);
  }
}

Config make_config(const py::object& base, const std::string& preset, const py::dict& settings) {
  ConfigSource source{.file = {}, .overrides = {}, .preset = preset};
  if (py::isinstance<Config>(base)) {
    source.kept = KeptConfig{.origin = "Config", .toml = to_toml(base.cast<const Config&>())};
  } else if (py::isinstance<py::dict>(base)) {
    add_overrides(source.overrides, py::reinterpret_borrow<py::dict>(base), "");
  } else if (py::isinstance<py::str>(base) || py::hasattr(base, "__fspath__")) {
    source.file = base.cast<std::filesystem::path>();
  } else if (!base.is_none()) {
    throw py::type_error(
        fmt::format("config: None, a Config, a dictionary or the path of a TOML file, not {}",
                    std::string(py::repr(base))));
  }
  add_overrides(source.overrides, settings, "");
  return loaded(source);
}

py::object value_of(const nlohmann::ordered_json& json) {
  return py::module_::import("json").attr("loads")(json.dump());
}

py::object setting_of(const Config& config, const std::string& name) {
  const nlohmann::ordered_json json = to_json(config);
  const std::size_t dot = name.find('.');
  const auto section = json.find(name.substr(0, dot));
  if (section != json.end() && dot == std::string::npos) {
    return value_of(*section);
  }
  if (section == json.end() || !section->contains(name.substr(dot + 1))) {
    throw py::key_error(name);
  }
  return value_of((*section)[name.substr(dot + 1)]);
}

}  // namespace

Config config_of(const py::object& source) {
  return make_config(source, {}, {});
}

void bind_configuration(py::module_& module) {
  py::class_<Config>(module, "Config",
                     "Settings, with the names, defaults and checks of `adit config`. Immutable.")
      .def(
          py::init(
              [](const py::object& source, const std::string& preset, const py::kwargs& settings) {
                return make_config(source, preset, settings);
              }),
          py::arg("source") = py::none(), py::kw_only(), py::arg("preset") = "",
          "Defaults, then the preset, then the TOML file or dictionary, then keywords by section:\n"
          "Config(\"adit.toml\", preprocess={\"r_input\": 0.5}, mapping={\"enabled\": True}).\n\n"
          "UsageError: a name that does not exist (with the nearest that does) or a value that\n"
          "makes no sense. InputError: the same in a file, with line and column.")
      .def("__getitem__", &setting_of, py::arg("name"),
           "The value of \"section.key\", or a section as a dictionary.")
      .def(
          "to_dict", [](const Config& config) { return value_of(to_json(config)); },
          "All settings by section; what is not given is None.")
      .def("to_toml", &to_toml, "The whole configuration as `adit config` prints it.")
      .def(py::pickle(
          [](const Config& config) { return state_of(py::str(to_toml(config))); },
          [](const py::tuple& state) { return parse_config(content_of(state), "pickled Config"); }))
      .def("__eq__",
           [](const Config& a, const py::object& b) {
             return py::isinstance<Config>(b) && to_toml(a) == to_toml(b.cast<const Config&>());
           })
      .def("__repr__", [](const Config& config) {
        const nlohmann::ordered_json now = to_json(config);
        const nlohmann::ordered_json usual = to_json(Config{});
        std::string text;
        for (const auto& [section, settings] : now.items()) {
          for (const auto& [key, value] : settings.items()) {
            if (value != usual[section][key]) {
              text +=
                  fmt::format("{}{}.{}={}", text.empty() ? "" : ", ", section, key, value.dump());
            }
          }
        }
        return "<adit.Config " + (text.empty() ? "of defaults" : text) + ">";
      });
  module.def("presets", &preset_names, "Names of the presets of public data sets.");
}

}  // namespace adit::python
