// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/device_session.hpp"

#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(DeviceSession, ComplaintsOfTheValidationLayerAreAFailure) {
  engine::Context context({.device = {}, .validation = true, .synchronization_validation = true});
  DeviceSession session({.device = {}, .opened = &context});
  EXPECT_NO_THROW(session.require_no_complaints());
  const engine::Buffer twice = context.make_buffer(4096, engine::Memory::device, "written twice");
  engine::Recorder recorder = context.make_recorder();
  recorder.fill(twice, 0);
  recorder.fill(twice, 1);  // without a barrier
  context.submit(std::move(recorder)).wait();
  try {
    session.require_no_complaints();
    FAIL() << "nothing was said";
  } catch (const std::runtime_error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("validation: ")) << error.what();
  }
}

}  // namespace
}  // namespace adit
