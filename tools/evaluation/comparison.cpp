// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <set>
#include <string_view>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

using Figure = std::optional<double>;

Figure if_any(std::size_t count, double value) {
  return count > 0 ? Figure(value) : std::nullopt;
}

/// One column of figures.
struct Column {
  std::string_view title;  ///< for people, with the unit
  std::string_view key;    ///< for programs
  int decimals = 3;
  bool is_error = true;  ///< less is better
  std::function<Figure(const Evaluation&)> figure;
};

const std::vector<Column>& columns() {
  static const std::vector<Column> kColumns = {
      {"poses", "poses", 0, false,
       [](const Evaluation& e) { return Figure(static_cast<double>(e.association.pairs)); }},
      {"of the path (%)", "covered_percent", 1, false,
       [](const Evaluation& e) {
         const AssociationSummary& a = e.association;
         return a.truth_path > 0.0 ? Figure(100.0 * a.covered_path / a.truth_path) : std::nullopt;
       }},
      {"ATE (m)", "ate_rmse_m", 3, true, [](const Evaluation& e) { return Figure(e.ate.rmse); }},
      {"largest (m)", "ate_max_m", 3, true, [](const Evaluation& e) { return Figure(e.ate.max); }},
      {"ATE (deg)", "ate_rotation_rmse_deg", 3, true,
       [](const Evaluation& e) {
         return if_any(e.rotation_determined ? 1 : 0, e.ate_rotation.rmse);
       }},
      {"RPE (m)", "rpe_rmse_m", 4, true,
       [](const Evaluation& e) { return if_any(e.rpe.translation.count, e.rpe.translation.rmse); }},
      {"RPE (deg)", "rpe_rotation_rmse_deg", 4, true,
       [](const Evaluation& e) { return if_any(e.rpe.rotation.count, e.rpe.rotation.rmse); }},
      {"KITTI (%)", "kitti_translation_percent", 3, true,
       [](const Evaluation& e) {
         return if_any(e.all_segments.count, 100.0 * e.all_segments.translation);
       }},
      {"KITTI (deg/100 m)", "kitti_rotation_deg_per_100m", 3, true, [](const Evaluation& e) {
         return if_any(e.all_segments.count, 100.0 * kDegreesPerRadian * e.all_segments.rotation);
       }}};
  return kColumns;
}

Figure figure_of(const ComparedEstimate& estimate, const Column& column) {
  return estimate.evaluation ? column.figure(*estimate.evaluation) : std::nullopt;
}

/// Whether this is the least of its column, as printed, among at least two.
bool is_best(const Comparison& comparison, const Column& column, const Figure& figure) {
  std::size_t figures = 0;
  double least = INFINITY;
  for (const ComparedEstimate& estimate : comparison.estimates) {
    if (const Figure other = figure_of(estimate, column)) {
      ++figures;
      least = std::fmin(least, *other);
    }
  }
  return column.is_error && figures > 1 && figure &&
         with_decimals(*figure, column.decimals) == with_decimals(least, column.decimals);
}

std::string escaped(const std::string& text, std::string_view special, const std::string& before) {
  std::string result;
  for (const char c : text) {
    result += special.find(c) == special.npos ? "" : before;
    result += c;
  }
  return result;
}

std::string in_latex(const std::string& text) {
  return escaped(text, "_%&#${}", "\\");
}

std::string in_csv(const std::string& text) {
  return text.find_first_of(",\"\n") == text.npos ? text : "\"" + escaped(text, "\"", "\"") + "\"";
}

/// A figure as the format shows it.
std::string cell(const Comparison& comparison, const ComparedEstimate& estimate,
                 const Column& column, TableFormat format) {
  const Figure figure = figure_of(estimate, column);
  if (!figure) {
    return "-";
  }
  const std::string text = with_decimals(*figure, column.decimals);
  if (!is_best(comparison, column, figure)) {
    return text;
  }
  switch (format) {
    case TableFormat::markdown:
      return "**" + text + "**";
    case TableFormat::latex:
      return "\\textbf{" + text + "}";
    default:
      return "*" + text;
  }
}

using Row = std::vector<std::string>;

/// Names and figures, the head first.
std::vector<Row> rows_of(const Comparison& comparison, TableFormat format) {
  const bool latex = format == TableFormat::latex;
  std::vector<Row> rows(1, {"estimate"});
  for (const Column& column : columns()) {
    const std::string title(column.title);
    rows[0].push_back(latex ? in_latex(title) : title);
  }
  for (const ComparedEstimate& estimate : comparison.estimates) {
    Row& row =
        rows.emplace_back(1, latex                             ? in_latex(estimate.name)
                             : format == TableFormat::markdown ? escaped(estimate.name, "|", "\\")
                                                               : estimate.name);
    for (const Column& column : columns()) {
      row.push_back(cell(comparison, estimate, column, format));
    }
  }
  return rows;
}

std::string joined(const Row& row, std::string_view between) {
  std::string text;
  for (std::size_t i = 0; i < row.size(); ++i) {
    text += (i == 0 ? "" : std::string(between)) + row[i];
  }
  return text;
}

std::string aligned_text(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string fill(widths[i] - row[i].size(), ' ');
      text += i == 0 ? row[i] + fill : "  " + fill + row[i];
    }
    text += "\n";
  }
  return text;
}

std::string markdown(const std::vector<Row>& rows) {
  std::string text = "| " + joined(rows[0], " | ") + " |\n|---|";
  for (std::size_t i = 1; i < rows[0].size(); ++i) {
    text += "---:|";
  }
  text += "\n";
  for (std::size_t i = 1; i < rows.size(); ++i) {
    text += "| " + joined(rows[i], " | ") + " |\n";
  }
  return text;
}

std::string latex(const std::vector<Row>& rows) {
  std::string text = "\\begin{tabular}{l" + std::string(rows[0].size() - 1, 'r') + "}\n\\hline\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    text += joined(rows[i], " & ") + " \\\\\n" + (i == 0 ? "\\hline\n" : "");
  }
  return text + "\\hline\n\\end{tabular}\n";
}

std::string csv(const Comparison& comparison) {
  std::string text = "estimate";
  for (const Column& column : columns()) {
    text += "," + std::string(column.key);
  }
  text += "\n";
  for (const ComparedEstimate& estimate : comparison.estimates) {
    text += in_csv(estimate.name);
    for (const Column& column : columns()) {
      text += ",";
      if (const Figure figure = figure_of(estimate, column)) {
        append_number(text, *figure);
      }
    }
    text += "\n";
  }
  return text;
}

/// The last `parts` names of the path.
std::string end_of(const std::filesystem::path& path, std::size_t parts) {
  std::filesystem::path end;
  std::filesystem::path rest = path.has_filename() ? path : path.parent_path();
  for (std::size_t i = 0; i < parts && rest.has_filename(); ++i) {
    end = end.empty() ? rest.filename() : rest.filename() / end;
    rest = rest.parent_path();
  }
  return end.string();
}

}  // namespace

bool Comparison::complete() const {
  return std::ranges::all_of(
      estimates, [](const ComparedEstimate& one) { return one.evaluation.has_value(); });
}

std::vector<std::string> short_names(const std::vector<std::filesystem::path>& paths) {
  constexpr std::size_t kMostParts = 8;
  std::vector<std::string> names;
  for (std::size_t parts = 1; parts <= kMostParts; ++parts) {
    names.clear();
    for (const std::filesystem::path& path : paths) {
      names.push_back(end_of(path, parts));
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) {
      break;
    }
  }
  return names;
}

std::string to_table(const Comparison& comparison, TableFormat format) {
  switch (format) {
    case TableFormat::text:
      return aligned_text(rows_of(comparison, format));
    case TableFormat::markdown:
      return markdown(rows_of(comparison, format));
    case TableFormat::latex:
      return latex(rows_of(comparison, format));
    case TableFormat::csv:
      return csv(comparison);
  }
  return {};
}

std::string notes_of(const Comparison& comparison) {
  std::string text;
  for (const ComparedEstimate& estimate : comparison.estimates) {
    text += estimate.note.empty() ? "" : estimate.name + ": " + estimate.note + "\n";
    if (estimate.evaluation) {
      for (const std::string& warning : estimate.evaluation->warnings) {
        text += estimate.name + ": warning: " + warning + "\n";
      }
    }
  }
  return text;
}

}  // namespace adit
