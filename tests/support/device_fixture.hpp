// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A context for tests that need a device. Which driver it finds is CTest's business
// (VK_DRIVER_FILES): every device test runs once on each software driver. The validation layer and
// synchronization validation are on, and a test that makes either of them say something fails;
// ADIT_TEST_VALIDATION=0 turns them off. ADIT_TEST_GPU_SHAPES=1 launches kernels as on a GPU.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/transfer.hpp"
#include "adit/engine/context.hpp"

namespace adit::test {

inline bool validation_wanted() {
  const char* wanted = std::getenv("ADIT_TEST_VALIDATION");
  return wanted == nullptr || std::string_view(wanted) != "0";
}

inline engine::ContextOptions test_options() {
  const char* device = std::getenv("ADIT_DEVICE");
  engine::ContextOptions options;
  options.device = device == nullptr ? "" : device;
  options.validation = validation_wanted();
  options.synchronization_validation = validation_wanted();
  options.profile = true;
  options.gpu_shapes = std::getenv("ADIT_TEST_GPU_SHAPES") != nullptr;
  return options;
}

/// One context for all tests of a suite: making one costs more than most tests do.
class DeviceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { context_ = new engine::Context(test_options()); }
  static void TearDownTestSuite() {
    delete context_;
    context_ = nullptr;
  }
  void SetUp() override { messages_before_ = context().validation_messages().size(); }
  void TearDown() override {
    const std::vector<std::string> messages = context().validation_messages();
    for (std::size_t i = messages_before_; i < messages.size(); ++i) {
      ADD_FAILURE() << "the validation layer says: " << messages[i];
    }
  }

  static engine::Context& context() { return *context_; }

  template <class T>
  static engine::Buffer upload(const std::vector<T>& values, std::string_view name = "test input") {
    return test::upload(context(), values, name);
  }
  template <class T>
  static std::vector<T> download(engine::Slice slice) {
    return test::download<T>(context(), slice);
  }
  /// Records what `record` says, runs it and waits.
  template <class Record>
  static std::vector<engine::ScopeTime> run(Record&& record) {
    engine::Recorder recorder = context().make_recorder();
    record(recorder);
    engine::Submission submission = context().submit(std::move(recorder));
    submission.wait();
    return submission.scope_times();
  }

 private:
  static inline engine::Context* context_ = nullptr;
  std::size_t messages_before_ = 0;
};

}  // namespace adit::test
