// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/sweep_message.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "adit/tools/foxglove/foxglove_messages.hpp"

namespace adit {
namespace {

/// The columns, and what is worked out of them.
std::vector<SweepColumn> shown_columns(const SweepRecord& sweep) {
  std::vector<SweepColumn> columns = columns_of(sweep);
  const Eigen::Matrix<double, 6, 1> variances = sweep.uncertainty.in_map().diagonal();
  columns.push_back({"position_sigma_m", std::sqrt(variances.head<3>().sum())});
  columns.push_back({"attitude_sigma_rad", std::sqrt(variances.tail<3>().sum())});
  return columns;
}

}  // namespace

ProtobufMessageType sweep_message_type() {
  ProtobufMessageType type{.name = "adit.Sweep", .fields = {}};
  for (const SweepColumn& column : shown_columns(SweepRecord())) {
    ProtobufField field{.number = static_cast<int>(type.fields.size()) + 1, .name = column.name};
    if (std::holds_alternative<Nanoseconds>(column.value)) {
      field.name = "timestamp";
      field.type = ProtobufType::message;
      field.type_name = "google.protobuf.Timestamp";
    } else if (std::holds_alternative<std::string>(column.value)) {
      field.type = ProtobufType::text;
    }
    type.fields.push_back(std::move(field));
  }
  return type;
}

ProtobufMessage sweep_message(const SweepRecord& sweep) {
  ProtobufMessage message;
  int number = 0;
  for (const SweepColumn& column : shown_columns(sweep)) {
    ++number;
    if (const auto* stamp = std::get_if<Nanoseconds>(&column.value)) {
      message.message(number, protobuf_of(*stamp));
    } else if (const auto* word = std::get_if<std::string>(&column.value)) {
      message.text(number, *word);
    } else {
      message.number(number, std::get<double>(column.value));
    }
  }
  return message;
}

}  // namespace adit
