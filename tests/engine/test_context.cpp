// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <link.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/environment.hpp"

namespace adit::engine {
namespace {

template <class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

ContextOptions named(std::string device) {
  ContextOptions options;
  options.device = std::move(device);
  return options;
}

TEST(Context, EveryDeviceOfTheTestMeetsTheBaseline) {
  const std::vector<DeviceInfo> devices = list_devices();
  ASSERT_FALSE(devices.empty());
  for (const DeviceInfo& device : devices) {
    EXPECT_TRUE(device.unified_memory || !device.software) << device.name;
    EXPECT_GE(device.requirements.size(), 20U);
    for (const Requirement& requirement : device.requirements) {
      EXPECT_TRUE(requirement.met) << device.name << ": " << requirement.name << " needs "
                                   << requirement.needed << ", has " << requirement.has;
    }
  }
}

TEST(Context, DeviceIsOpenedByIndexNameAndUuid) {
  const DeviceInfo first = list_devices().front();
  for (const std::string& name :
       {std::to_string(first.index), first.uuid, first.name, first.name.substr(0, 5)}) {
    const Context context(named(name));
    EXPECT_EQ(context.device().uuid, first.uuid);
    EXPECT_FALSE(context.software_fallback());
  }
}

// NVIDIA's driver can be loaded some ten times in a process, and then no more.
TEST(Context, DriversStayLoaded) {
  const auto loaded = [] {
    std::set<std::string> names;
    dl_iterate_phdr(
        [](dl_phdr_info* library, std::size_t /*bytes*/, void* found) {
          static_cast<std::set<std::string>*>(found)->emplace(library->dlpi_name);
          return 0;
        },
        &names);
    return names;
  };
  std::set<std::string> during;
  {
    const Context context(named(""));
    during = loaded();
  }
  EXPECT_EQ(loaded(), during);
}

TEST(Context, OnlySoftwareAndNothingAskedForIsAFallback) {
  const Context context(named(""));
  EXPECT_EQ(context.software_fallback(),
            std::ranges::all_of(list_devices(), &DeviceInfo::software));
}

TEST(Context, DeviceThatDoesNotExistIsAnErrorThatListsWhatThereIs) {
  const std::string text = message([] { Context context(named("Voodoo 2")); });
  EXPECT_NE(text.find("Voodoo 2"), std::string::npos) << text;
  EXPECT_NE(text.find(list_devices().front().name), std::string::npos) << text;
}

TEST(Context, MachineWithoutADriverIsToldWhatToInstall) {
  const test::Variable no_driver("VK_DRIVER_FILES", "/nonexistent/driver.json");
  const test::Variable older_name("VK_ICD_FILENAMES", "/nonexistent/driver.json");
  const std::string text = message([] { Context context(named("")); });
  EXPECT_NE(text.find("no Vulkan driver"), std::string::npos) << text;
  EXPECT_NE(text.find("mesa-vulkan-drivers"), std::string::npos) << text;
  EXPECT_EQ(message([] { list_devices(); }), text);
}

TEST(Context, MissingValidationLayerNamesItsPackage) {
  const test::Variable no_layers("VK_LAYER_PATH", "/nonexistent");
  ContextOptions options;
  options.validation = true;
  const std::string text = message([&] { Context context(options); });
  EXPECT_NE(text.find("vulkan-validationlayers"), std::string::npos) << text;
}

TEST(Context, TakesThePipelineCacheOfAnEarlierOneAndNothingElse) {
  std::vector<std::byte> kept;
  {
    Context context(test::test_options());
    const Kernel kernel(context, "engine_probe");
    kept = context.pipeline_cache();  // empty where the driver keeps nothing in it
  }
  std::vector<std::byte> foreign = kept;
  for (std::size_t i = 8; i < std::min<std::size_t>(16, foreign.size()); ++i) {
    foreign[i] ^= std::byte{0xff};  // vendor and device
  }
  const std::vector<std::byte> noise(5000, std::byte{0x5a});
  Context context(test::test_options());
  for (const std::vector<std::byte>& bytes : {std::vector<std::byte>(), noise, foreign, kept}) {
    context.add_to_pipeline_cache(bytes);
    context.add_to_pipeline_cache(std::span(bytes).first(std::min<std::size_t>(20, bytes.size())));
  }
  const Kernel kernel(context, "engine_probe");
  EXPECT_EQ(kernel.name(), "engine_probe");
  EXPECT_TRUE(context.validation_messages().empty());
}

TEST(Context, CanBeMovedWhileItsBuffersLive) {
  std::optional<Context> last;  // outlives the buffer
  Context first(named(""));
  const Buffer buffer = first.make_buffer(1000, Memory::upload, "kept");
  last.emplace(std::move(first));
  EXPECT_EQ(last->memory_in_use(), 1024U);
  EXPECT_EQ(buffer.size(), 1000U);
}

/// What its calls throw in a process that is forked for it; "hangs" where it does not end.
template <class Call>
std::string message_in_child(Call&& call) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    return "no pipe";
  }
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);  // ends it
    const std::string text = message(call);
    _exit(write(ends[1], text.data(), text.size()) < 0 ? 1 : 0);
  }
  close(ends[1]);
  std::string text(1000, ' ');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(read(ends[0], text.data(), 1000), 0)));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? text : "hangs";
}

TEST(Context, IsRefusedInAForkedProcessInsteadOfHanging) {
  Context context(test::test_options());
  Kernel kernel(context, "engine_probe");
  Buffer buffer = context.make_buffer(1000, Memory::upload, "of the parent");
  Submission under_way = context.submit(context.make_recorder());
  const std::vector<std::function<void()>> calls = {
      [&] { context.make_buffer(1000, Memory::device, "of the child"); },
      [&] { static_cast<void>(context.make_recorder()); },
      [&] { const Kernel another(context, "engine_probe"); },
      [&] { under_way.wait(); },
      [&] { static_cast<void>(buffer.mapped()); },
      [&] { const Context another(test::test_options()); },
  };
  for (const std::function<void()>& call : calls) {
    const std::string text = message_in_child(call);
    EXPECT_NE(text.find("does not survive a fork"), std::string::npos) << text;
    EXPECT_NE(text.find("spawn"), std::string::npos) << text;
  }
  const auto destroy_all = [&] {
    const Buffer buffer_gone = std::move(buffer);
    const Kernel kernel_gone = std::move(kernel);
    const Submission submission_gone = std::move(under_way);
    const Context context_gone = std::move(context);
  };
  EXPECT_EQ(message_in_child(destroy_all), "no error") << "all is left as it is";
  under_way.wait();
  context.submit(context.make_recorder()).wait();
}

}  // namespace
}  // namespace adit::engine
