// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a GPU's compiler makes of the kernels, beside what it made of them when that was last
// stored: no spills, and no fewer waves. `adit bench --compile FAMILY... --json FILE` writes the
// file anew.
#include "adit/benchmarks/kernels/compile_table.hpp"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/engine/error.hpp"
#include "adit/shaders/embedded.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

std::vector<CompileTable> stored_tables() {
  std::ifstream stream(test::tree() / "benchmarks/results/compiled_by_radv.json");
  return tables_of(nlohmann::ordered_json::parse(stream));
}

std::string name_of(const CompiledKernel& row) {
  return row.kernel + " " + row.constants;
}

TEST(CompileTable, NothingSpillsAndWavesDoNotFall) {
  const std::vector<CompileTable> stored = stored_tables();
  ASSERT_GE(stored.size(), 3U);
  for (const CompileTable& before : stored) {
    SCOPED_TRACE(before.family);
    CompileTable now;
    try {
      now = compile_table(before.family);
    } catch (const engine::Error& error) {
      GTEST_SKIP() << "not compiled for any GPU: " << error.what();
    }
    const bool comparable = now.driver == before.driver;
    if (!comparable) {
      std::cout << "waves are not compared: the table is of " << before.driver << ", this is "
                << now.driver << "\n";
    }
    std::set<std::string> names;
    for (const CompiledKernel& row : now.kernels) {
      SCOPED_TRACE(name_of(row));
      names.insert(row.kernel);
      EXPECT_EQ(row.value(kSpilledVectors), 0.0);
      EXPECT_EQ(row.value(kSpilledScalars), 0.0);
      EXPECT_GT(row.value(kWaves), 0.0);
      const auto same = std::ranges::find(before.kernels, name_of(row), name_of);
      if (same == before.kernels.end()) {
        ADD_FAILURE() << "is not in the stored table: write it anew";
      } else if (comparable) {
        EXPECT_GE(row.value(kWaves), same->value(kWaves));
      }
    }
    EXPECT_EQ(now.kernels.size(), before.kernels.size());
    for (const std::string_view shader : shaders::names()) {
      EXPECT_TRUE(names.contains(std::string(shader))) << shader << " is not compiled";
    }
  }
}

TEST(CompileTable, IsTheSameAfterJson) {
  const CompileTable table{
      .family = "NAVI21",
      .driver = "some driver 1",
      .kernels = {{.kernel = "deskew", .constants = "0=64", .values = {{"VGPRs", 24.0}}}}};
  const std::vector<CompileTable> again = tables_of(tables_to_json({table}));
  ASSERT_EQ(again.size(), 1U);
  EXPECT_EQ(again[0].family, table.family);
  EXPECT_EQ(again[0].driver, table.driver);
  ASSERT_EQ(again[0].kernels.size(), 1U);
  EXPECT_EQ(name_of(again[0].kernels[0]), "deskew 0=64");
  EXPECT_EQ(again[0].kernels[0].value("VGPRs"), 24.0);
  EXPECT_EQ(again[0].kernels[0].value("SGPRs"), 0.0);
  std::ostringstream text;
  print(again[0], text);
  EXPECT_NE(text.str().find("deskew"), std::string::npos);
}

TEST(CompileTable, AFamilyThatRadvDoesNotKnowIsRefused) {
  EXPECT_THROW(compile_table("NAVI99"), UsageError);
}

}  // namespace
}  // namespace adit::bench
