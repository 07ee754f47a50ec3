// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/device_session.hpp"

#include <chrono>
#include <cstdlib>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "adit/engine/error.hpp"
#include "adit/engine/self_test/self_test.hpp"
#include "adit/tools/setup/device_cache.hpp"
#include "adit/tools/support/message_buffer.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

void require_known_answers(const engine::SelfTestReport& report, const engine::DeviceInfo& device) {
  if (report.passed()) {
    return;
  }
  std::string message =
      "the device '" + device.name + "' is refused: its kernels do not give the known answers";
  for (const engine::SelfTestCase& test : report.cases) {
    if (!test.passed) {
      message += "\n  " + test.kernel + ": " + test.detail;
    }
  }
  throw engine::Error(
      message + "\nUpdate its driver, or choose another device of `adit devices` with --device.");
}

// What a first start shows while it compiles. A signal is answered at once, though the driver
// cannot be stopped.
class CompilingProgress {
 public:
  CompilingProgress(std::ostream* stream, const engine::DeviceInfo& device) {
    if (stream != nullptr) {
      progress_.emplace(*stream, progress_style_of_stderr(), "compiling", 0, start_,
                        "kernel groups");
      progress_->note("note: compiling kernels for " + device.name + ", once for this device");
    }
  }

  void update(const engine::SelfTestProgress& state) {
    if (StopSignal::received() != 0 && !std::exchange(stopped_, true)) {
      note("note: stopping as soon as the driver has compiled the current kernels");
    }
    if (progress_) {
      progress_->set_total(state.total);
      progress_->update(state.done, 0);
    }
  }

  void finish() {
    if (progress_) {
      progress_->finish();
    }
    note(fmt::format("note: compiled and tested in {:.1f} s",
                     std::chrono::duration<double>(Clock::now() - start_).count()));
    if (StopSignal::received() != 0) {
      throw StoppedWhileCompiling(
          "stopped by a signal while kernels were compiled; no run started");
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  void note(const std::string& text) {
    if (progress_) {
      progress_->note(text);
    }
  }

  Clock::time_point start_ = Clock::now();
  std::optional<Progress> progress_;
  bool stopped_ = false;
};

// A device that no earlier run has tested.
void compile_and_test(engine::Context& context, const DeviceCache& cache, std::ostream* notes) {
  const engine::DeviceInfo& device = context.device();
  CompilingProgress compiling(notes, device);
  const engine::ParallelSelfTest test = engine::run_self_test(
      engine::ContextOptions{.device = std::to_string(device.index)},
      [&](const engine::SelfTestProgress& state) { compiling.update(state); });
  require_known_answers(test.report, device);
  for (const std::vector<std::byte>& pipelines : test.pipeline_caches) {
    context.add_to_pipeline_cache(pipelines);
  }
  cache.keep(device, context.pipeline_cache());
  compiling.finish();
}

}  // namespace

std::string requested_device(const std::string& option) {
  if (!option.empty()) {
    return option;
  }
  const char* environment = std::getenv("ADIT_DEVICE");
  return environment == nullptr ? std::string() : std::string(environment);
}

engine::Context open_device(const DeviceOptions& options) {
  const std::string requested = requested_device(options.device);
  give_mesa_a_cache();
  const auto detail = [&](const std::string& text) {
    if (options.notes != nullptr) {
      say_detail(*options.notes, text);
    }
  };
  try {
    engine::Context context({.device = requested,
                             .validation = options.validation,
                             .synchronization_validation = options.validation,
                             .profile = options.profile,
                             .memory_budget_bytes = options.max_vram_bytes});
    detail("device: " + describe(context.device()) +
           (requested.empty() ? ", the first that fits" : ", asked for as " + requested));
    if (options.validation) {
      // Here, where the layer's messages are collected, and whatever is known of the device.
      require_known_answers(engine::run_self_test(context), context.device());
      return context;
    }
    const DeviceCache cache(cache_folder());
    if (const auto pipelines = cache.find(context.device())) {
      context.add_to_pipeline_cache(*pipelines);
      detail("its kernels were tested by an earlier run, as " +
             cache.file_of(context.device())->string() + " has it");
    } else {
      compile_and_test(context, cache, options.notes);
    }
    return context;
  } catch (const engine::NoSuchDevice& error) {
    throw UsageError((options.device.empty() ? "ADIT_DEVICE: " : "--device: ") +
                     std::string(error.what()));
  }
}

DeviceSession::~DeviceSession() {
  try {
    if (own_ && own_->pipeline_cache().size() > kept_bytes_) {
      DeviceCache(cache_folder()).keep(own_->device(), own_->pipeline_cache());
    }
  } catch (const std::exception&) {
    // Then the next run compiles again.
  }
}

void DeviceSession::require_no_complaints() const {
  const std::vector<std::string> complaints = context_->validation_messages();
  if (!complaints.empty()) {
    throw std::runtime_error(
        fmt::format("validation: {}", fmt::join(complaints, "\nvalidation: ")));
  }
}

std::string software_note(const engine::DeviceInfo& device) {
  return "note: no GPU was found; the CPU does its work in software (" + describe(device) + ")";
}

std::string describe(const engine::DeviceInfo& device) {
  return device.name + ", " + device.driver + " " + device.driver_version +
         (device.software ? ", software" : "");
}

std::string describe(const engine::OutOfMemory& error) {
  return std::string(error.what()) +
         ". Where --max-vram bounds it, allow more; else take a device with more memory (`adit "
         "devices`)";
}

nlohmann::ordered_json to_json(const engine::DeviceInfo& device) {
  return {{"index", device.index},
          {"name", device.name},
          {"uuid", device.uuid},
          {"driver", device.driver},
          {"driver_version", device.driver_version},
          {"api_version", device.api_version},
          {"software", device.software},
          {"unified_memory", device.unified_memory},
          {"subgroup_size", device.subgroup_size},
          {"memory_bytes", device.device_memory_bytes}};
}

}  // namespace adit
