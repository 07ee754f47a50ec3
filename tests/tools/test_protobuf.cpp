// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/protobuf_fields.hpp"
#include "adit/tools/containers/protobuf_message.hpp"
#include "adit/tools/containers/protobuf_schema.hpp"
#include "adit/tools/foxglove/foxglove_types.hpp"
#include "adit/tools/foxglove/sweep_message.hpp"

namespace adit {
namespace {

std::string wire_of(const ProtobufMessage& message) {
  return {reinterpret_cast<const char*>(message.content().data()), message.content().size()};
}

TEST(Protobuf, BytesAreThoseOfTheSpecification) {
  ProtobufMessage message;
  message.integer(1, 150);
  EXPECT_EQ(wire_of(message), "\x08\x96\x01");
  message.text(2, "testing");
  EXPECT_EQ(wire_of(message), "\x08\x96\x01\x12\x07testing");
  ProtobufMessage outer;
  outer.message(3, message);
  EXPECT_EQ(wire_of(outer), "\x1a\x0c\x08\x96\x01\x12\x07testing");
  ProtobufMessage negative;
  negative.integer(1, -2);
  EXPECT_EQ(wire_of(negative), "\x08\xfe\xff\xff\xff\xff\xff\xff\xff\xff\x01");
}

TEST(Protobuf, EveryKindOfValueIsReadBack) {
  ProtobufMessage message;
  message.number(1, -0.1);
  message.integer(16, std::numeric_limits<int64_t>::min());
  message.fixed(17, 0xFFFFFFFFU);
  message.text(18, "");
  message.numbers(200, std::array{1.0, 2.5});
  const test::ProtobufFields fields(message.content());
  EXPECT_EQ(fields.real(1), -0.1);
  EXPECT_EQ(fields.integer(16), std::numeric_limits<int64_t>::min());
  EXPECT_EQ(fields.fixed(17), 0xFFFFFFFFU);
  EXPECT_EQ(fields.text(18), "");
  EXPECT_EQ(fields.text(200).size(), 16U);
}

TEST(Protobuf, FilesOfADescriptorSetComeAfterThoseTheyNeed) {
  const test::ProtobufFields set(descriptor_set(foxglove_types(), "foxglove.SceneUpdate"));
  std::set<std::string> seen;
  for (const test::ProtobufFields& file : set.parts(1)) {
    for (const test::ProtobufFields& message : file.parts(4)) {
      EXPECT_FALSE(message.text(1).empty());
    }
    EXPECT_EQ(file.text(12), "proto3");
    seen.insert(file.text(1));
  }
  EXPECT_TRUE(seen.contains("foxglove/SceneUpdate.proto"));
  EXPECT_TRUE(seen.contains("google/protobuf/timestamp.proto"));
  EXPECT_FALSE(seen.contains("foxglove/Log.proto")) << "which no scene needs";
  const auto files = set.parts(1);
  EXPECT_EQ(files.back().text(1), "foxglove/SceneUpdate.proto");
  EXPECT_EQ(files.back().text(2), "foxglove");
  EXPECT_EQ(seen.size(), files.size()) << "each once";
}

TEST(Protobuf, AnOptionalFieldIsAChoiceOfOne) {
  const std::vector<ProtobufMessageType> types = {
      {.name = "a.B",
       .fields = {{.number = 1, .name = "x"}, {.number = 2, .name = "y", .optional = true}}}};
  const test::ProtobufFields set(descriptor_set(types, "a.B"));
  const test::ProtobufFields message = set.part(1).part(4);
  EXPECT_EQ(message.part(8).text(1), "_y");
  EXPECT_EQ(message.parts(2)[0].count(9), 0U);
  EXPECT_EQ(message.parts(2)[1].integer(9), 0);
  EXPECT_EQ(message.parts(2)[1].integer(17), 1);
}

TEST(Protobuf, FieldsHaveNoOtherName) {
  const std::vector<ProtobufMessageType> types = {
      {.name = "a.B", .fields = {{.number = 1, .name = "frame_id"}}}};
  const test::ProtobufFields field =
      test::ProtobufFields(descriptor_set(types, "a.B")).part(1).part(4).part(2);
  EXPECT_EQ(field.text(1), "frame_id");
  EXPECT_EQ(field.count(10), 0U) << "json_name, which some readers would take instead";
}

TEST(Protobuf, ATypeThatIsNotKnownIsAMistakeOfTheProgram) {
  EXPECT_THROW(descriptor_set(foxglove_types(), "foxglove.Nothing"), std::logic_error);
}

TEST(Protobuf, ASweepHasTheColumnsOfItsTable) {
  SweepRecord record;
  record.stamp = Nanoseconds(1'500'000'007);
  record.state = "tracking";
  record.overlap = 0.75;
  record.uncertainty = {.local = Matrix6d::Identity(), .drift = Matrix6d::Zero()};
  const test::ProtobufFields sweep(sweep_message(record).content());
  const auto at = [](const std::string& name) {
    const ProtobufMessageType type = sweep_message_type();
    for (const ProtobufField& field : type.fields) {
      if (field.name == name) {
        return field.number;
      }
    }
    ADD_FAILURE() << name;
    return 0;
  };
  EXPECT_EQ(sweep.part(at("timestamp")).integer(1), 1);
  EXPECT_EQ(sweep.part(at("timestamp")).integer(2), 500'000'007);
  EXPECT_EQ(sweep.text(at("state")), "tracking");
  EXPECT_EQ(sweep.real(at("overlap")), 0.75);
  EXPECT_TRUE(std::isnan(sweep.real(at("residual_rms_m")))) << "not known is not 0";
  EXPECT_NEAR(sweep.real(at("position_sigma_m")), std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace adit
