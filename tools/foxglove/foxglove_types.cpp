// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_types.hpp"

#include <utility>

namespace adit {
namespace {

constexpr const char* kTimestamp = "google.protobuf.Timestamp";

ProtobufField scalar_field(int field, std::string name, ProtobufType type) {
  return {.number = field, .name = std::move(name), .type = type};
}
ProtobufField message_field(int field, std::string name, std::string type) {
  return {.number = field,
          .name = std::move(name),
          .type = ProtobufType::message,
          .type_name = std::move(type)};
}
ProtobufField repeated_field(int field, std::string name, std::string type) {
  ProtobufField repeated = message_field(field, std::move(name), std::move(type));
  repeated.repeated = true;
  return repeated;
}
ProtobufField repeated_field(int field, std::string name, ProtobufType type) {
  ProtobufField repeated = scalar_field(field, std::move(name), type);
  repeated.repeated = true;
  return repeated;
}
ProtobufField word_field(int field, std::string name, std::string enumeration_name) {
  return {.number = field,
          .name = std::move(name),
          .type = ProtobufType::enumeration,
          .type_name = std::move(enumeration_name)};
}
ProtobufField optional_field(ProtobufField field) {
  field.optional = true;
  return field;
}

/// Doubles numbered from 1.
ProtobufMessageType tuple_type(std::string name, const std::vector<std::string>& parts) {
  ProtobufMessageType type{.name = std::move(name), .fields = {}};
  for (const std::string& part : parts) {
    type.fields.push_back(
        scalar_field(static_cast<int>(type.fields.size()) + 1, part, ProtobufType::number));
  }
  return type;
}

std::vector<ProtobufMessageType> small_types() {
  using enum ProtobufType;
  return {
      {.name = kTimestamp,
       .fields = {scalar_field(1, "seconds", int64), scalar_field(2, "nanos", int32)}},
      {.name = "google.protobuf.Duration",
       .fields = {scalar_field(1, "seconds", int64), scalar_field(2, "nanos", int32)}},
      tuple_type("foxglove.Vector3", {"x", "y", "z"}),
      tuple_type("foxglove.Point3", {"x", "y", "z"}),
      tuple_type("foxglove.Quaternion", {"x", "y", "z", "w"}),
      tuple_type("foxglove.Color", {"r", "g", "b", "a"}),
      {.name = "foxglove.Pose",
       .fields = {message_field(1, "position", "foxglove.Vector3"),
                  message_field(2, "orientation", "foxglove.Quaternion")}},
      {.name = "foxglove.KeyValuePair",
       .fields = {scalar_field(1, "key", text), scalar_field(2, "value", text)}},
      {.name = "foxglove.PackedElementField",
       .fields = {scalar_field(1, "name", text), scalar_field(2, "offset", fixed32),
                  word_field(3, "type", "foxglove.PackedElementField.NumericType")},
       .enumerations = {{.name = "NumericType",
                         .values = {"UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32",
                                    "INT32", "FLOAT32", "FLOAT64"}}}},
  };
}

std::vector<ProtobufMessageType> scene_types() {
  using enum ProtobufType;
  const ProtobufField pose = message_field(1, "pose", "foxglove.Pose");
  const ProtobufField size = message_field(2, "size", "foxglove.Vector3");
  return {
      {.name = "foxglove.ArrowPrimitive",
       .fields = {pose, scalar_field(2, "shaft_length", number),
                  scalar_field(3, "shaft_diameter", number), scalar_field(4, "head_length", number),
                  scalar_field(5, "head_diameter", number),
                  message_field(6, "color", "foxglove.Color")}},
      {.name = "foxglove.CubePrimitive",
       .fields = {pose, size, message_field(3, "color", "foxglove.Color")}},
      {.name = "foxglove.SpherePrimitive",
       .fields = {pose, size, message_field(3, "color", "foxglove.Color")}},
      {.name = "foxglove.CylinderPrimitive",
       .fields = {pose, size, scalar_field(3, "bottom_scale", number),
                  scalar_field(4, "top_scale", number),
                  message_field(5, "color", "foxglove.Color")}},
      {.name = "foxglove.LinePrimitive",
       .fields = {word_field(1, "type", "foxglove.LinePrimitive.Type"),
                  message_field(2, "pose", "foxglove.Pose"), scalar_field(3, "thickness", number),
                  scalar_field(4, "scale_invariant", boolean),
                  repeated_field(5, "points", "foxglove.Point3"),
                  message_field(6, "color", "foxglove.Color"),
                  repeated_field(7, "colors", "foxglove.Color"),
                  repeated_field(8, "indices", fixed32)},
       .enumerations = {{.name = "Type", .values = {"LINE_STRIP", "LINE_LOOP", "LINE_LIST"}}}},
      {.name = "foxglove.TriangleListPrimitive",
       .fields = {pose, repeated_field(2, "points", "foxglove.Point3"),
                  message_field(3, "color", "foxglove.Color"),
                  repeated_field(4, "colors", "foxglove.Color"),
                  repeated_field(5, "indices", fixed32)}},
      {.name = "foxglove.TextPrimitive",
       .fields = {pose, scalar_field(2, "billboard", boolean), scalar_field(3, "font_size", number),
                  scalar_field(4, "scale_invariant", boolean),
                  message_field(5, "color", "foxglove.Color"), scalar_field(6, "text", text)}},
      {.name = "foxglove.ModelPrimitive",
       .fields = {pose, message_field(2, "scale", "foxglove.Vector3"),
                  message_field(3, "color", "foxglove.Color"),
                  scalar_field(4, "override_color", boolean), scalar_field(5, "url", text),
                  scalar_field(6, "media_type", text), scalar_field(7, "data", bytes)}},
      {.name = "foxglove.SceneEntity",
       .fields = {message_field(1, "timestamp", kTimestamp), scalar_field(2, "frame_id", text),
                  scalar_field(3, "id", text),
                  message_field(4, "lifetime", "google.protobuf.Duration"),
                  scalar_field(5, "frame_locked", boolean),
                  repeated_field(6, "metadata", "foxglove.KeyValuePair"),
                  repeated_field(7, "arrows", "foxglove.ArrowPrimitive"),
                  repeated_field(8, "cubes", "foxglove.CubePrimitive"),
                  repeated_field(9, "spheres", "foxglove.SpherePrimitive"),
                  repeated_field(10, "cylinders", "foxglove.CylinderPrimitive"),
                  repeated_field(11, "lines", "foxglove.LinePrimitive"),
                  repeated_field(12, "triangles", "foxglove.TriangleListPrimitive"),
                  repeated_field(13, "texts", "foxglove.TextPrimitive"),
                  repeated_field(14, "models", "foxglove.ModelPrimitive")}},
      {.name = "foxglove.SceneEntityDeletion",
       .fields = {message_field(1, "timestamp", kTimestamp),
                  word_field(2, "type", "foxglove.SceneEntityDeletion.Type"),
                  scalar_field(3, "id", text)},
       .enumerations = {{.name = "Type", .values = {"MATCHING_ID", "ALL"}}}},
      {.name = "foxglove.SceneUpdate",
       .fields = {repeated_field(1, "deletions", "foxglove.SceneEntityDeletion"),
                  repeated_field(2, "entities", "foxglove.SceneEntity")}},
  };
}

std::vector<ProtobufMessageType> stamped_types() {
  using enum ProtobufType;
  const ProtobufField timestamp = message_field(1, "timestamp", kTimestamp);
  return {
      {.name = "foxglove.FrameTransform",
       .fields = {timestamp, scalar_field(2, "parent_frame_id", text),
                  scalar_field(3, "child_frame_id", text),
                  message_field(4, "translation", "foxglove.Vector3"),
                  message_field(5, "rotation", "foxglove.Quaternion")}},
      {.name = "foxglove.PoseInFrame",
       .fields = {timestamp, scalar_field(2, "frame_id", text),
                  message_field(3, "pose", "foxglove.Pose")}},
      {.name = "foxglove.PointCloud",
       .fields = {timestamp, scalar_field(2, "frame_id", text),
                  message_field(3, "pose", "foxglove.Pose"),
                  scalar_field(4, "point_stride", fixed32),
                  repeated_field(5, "fields", "foxglove.PackedElementField"),
                  scalar_field(6, "data", bytes)}},
      {.name = "foxglove.LocationFix",
       .fields = {message_field(6, "timestamp", kTimestamp), scalar_field(7, "frame_id", text),
                  scalar_field(1, "latitude", number), scalar_field(2, "longitude", number),
                  scalar_field(3, "altitude", number),
                  repeated_field(4, "position_covariance", number),
                  word_field(5, "position_covariance_type",
                             "foxglove.LocationFix.PositionCovarianceType"),
                  optional_field(message_field(8, "color", "foxglove.Color")),
                  repeated_field(9, "metadata", "foxglove.KeyValuePair")},
       .enumerations = {{.name = "PositionCovarianceType",
                         .values = {"UNKNOWN", "APPROXIMATED", "DIAGONAL_KNOWN", "KNOWN"}}}},
      {.name = "foxglove.Log",
       .fields = {timestamp, word_field(2, "level", "foxglove.Log.Level"),
                  scalar_field(3, "message", text), scalar_field(4, "name", text),
                  scalar_field(5, "file", text), scalar_field(6, "line", fixed32)},
       .enumerations = {{.name = "Level",
                         .values = {"UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"}}}},
  };
}

}  // namespace

std::vector<ProtobufMessageType> foxglove_types() {
  std::vector<ProtobufMessageType> all = small_types();
  for (const auto& some : {scene_types(), stamped_types()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

McapSchema protobuf_mcap_schema(const std::vector<ProtobufMessageType>& known,
                                const std::string& name) {
  return {.name = name,
          .encoding = "protobuf",
          .data = descriptor_set(known, name),
          .message_encoding = "protobuf"};
}

}  // namespace adit
