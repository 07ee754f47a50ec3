// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/report.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/tools/support/input_error.hpp"

namespace adit::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "bench/1";
constexpr const char* kRemedy = "Give a file that `adit bench --json FILE` wrote";
constexpr std::array kKinds = {CaseKind::kernel, CaseKind::registration, CaseKind::batch,
                               CaseKind::peer};

// Names of members, for writing and reading alike.
template <class Self, class Visitor>
void visit(Self& self, Visitor&& field) requires std::same_as<std::remove_const_t<Self>, Setting> {
  field("version", self.version);
  field("commit", self.commit);
  field("date", self.date);
  field("device", self.device);
  field("driver", self.driver);
  field("driver_version", self.driver_version);
  field("vulkan", self.vulkan);
  field("software", self.software);
  field("host", self.host);
  field("threads", self.threads);
  field("peers", self.peers);
  field("input", self.input);
  field("seconds_a_case", self.seconds);
}

template <class Self, class Visitor>
void visit(Self& self,
           Visitor&& field) requires std::same_as<std::remove_const_t<Self>, DeviceLimits> {
  field("copy_bytes_per_s", self.copy_bytes);
  field("flop_per_s", self.flop);
  field("far_reads_per_s", self.reads);
  field("near_reads_per_s", self.near_reads);
  field("atomics_per_s", self.atomics);
  field("dispatch_s", self.dispatch_s);
  field("submission_s", self.submission_s);
}

template <class Self, class Visitor>
void visit(Self& self, Visitor&& field) requires std::same_as<std::remove_const_t<Self>, Cost> {
  field("bytes", self.bytes);
  field("flop", self.flop);
  field("reads", self.reads);
  field("atomics", self.atomics);
  field("dispatches", self.dispatches);
}

template <class Self, class Visitor>
void visit(Self& self, Visitor&& field) requires std::same_as<std::remove_const_t<Self>, Spread> {
  field("low", self.low);
  field("median", self.median);
  field("high", self.high);
}

template <class Self, class Visitor>
void visit(Self& self, Visitor&& field) requires std::same_as<std::remove_const_t<Self>, Row> {
  field("name", self.name);
  field("size", self.size);
  field("item", self.item);
  field("peer", self.peer);
  field("items", self.items);
  field("verified_by", self.verified_by);
  field("problem", self.problem);
  field("figures", self.figures);
}

template <class T>
Json write(const T& value) {
  Json json;
  visit(value, [&](const char* name, const auto& member) { json[name] = member; });
  return json;
}

template <class T>
T read(const Json& json) {
  T value;
  visit(value, [&](const char* name, auto& member) { json.at(name).get_to(member); });
  return value;
}

Json write_clock(const std::optional<Spread>& spread) {
  return spread ? write(*spread) : Json();
}

std::optional<Spread> read_clock(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(read<Spread>(json));
}

CaseKind kind_of(const std::string& name, const std::filesystem::path& path) {
  for (const CaseKind kind : kKinds) {
    if (to_string(kind) == name) {
      return kind;
    }
  }
  throw InputError(path, Place::named("kind"), "'" + name + "' is no kind of case", kRemedy);
}

}  // namespace

Json to_json(const Report& report) {
  Json json = {{"schema", kSchema},
               {"setting", write(report.setting)},
               {"limits", write(report.limits)},
               {"limits_moved",
                {{"ratio", report.limits_moved.ratio}, {"which", report.limits_moved.which}}},
               {"rows", Json::array()}};
  for (const Row& row : report.rows) {
    Json one = write(row);
    one["kind"] = to_string(row.kind);
    one["runs"] = row.timing.runs;
    one["device_ms"] = write_clock(row.timing.device);
    one["wait_ms"] = write_clock(row.timing.wait);
    one["host_ms"] = write(row.timing.host);
    one["cost"] = write(row.cost);
    json["rows"].push_back(one);
  }
  return json;
}

Report read_report(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) {
    throw InputError(path, {}, "it cannot be opened", kRemedy);
  }
  try {
    const Json json = Json::parse(in);
    if (json.at("schema") != kSchema) {
      throw InputError(path, Place::named("schema"),
                       "found " + json.at("schema").dump() + ", expected " + kSchema,
                       "Measure again with this version");
    }
    Report report{.setting = read<Setting>(json.at("setting")),
                  .limits = read<DeviceLimits>(json.at("limits"))};
    if (const auto moved = json.find("limits_moved"); moved != json.end()) {
      report.limits_moved = {moved->at("ratio").get<double>(),
                             moved->at("which").get<std::string>()};
    }
    for (const Json& one : json.at("rows")) {
      Row row = read<Row>(one);
      row.kind = kind_of(one.at("kind"), path);
      row.timing = {.runs = one.at("runs"),
                    .device = read_clock(one.at("device_ms")),
                    .wait = read_clock(one.at("wait_ms")),
                    .host = read<Spread>(one.at("host_ms"))};
      row.cost = read<Cost>(one.at("cost"));
      report.rows.push_back(std::move(row));
    }
    return report;
  } catch (const Json::exception& error) {
    throw InputError(path, {}, std::string("it is not a report of benchmarks: ") + error.what(),
                     kRemedy);
  }
}

const Row* peer_of(const Row& row, const Report& report) {
  const auto found = std::ranges::find_if(report.rows, [&](const Row& other) {
    return !row.peer.empty() && other.name == row.peer && other.size == row.size;
  });
  return found == report.rows.end() ? nullptr : &*found;
}

}  // namespace adit::bench
