// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Every struct of shaders/shared that kernels use: C++ and GLSL agree on each member's place.
#include <cstddef>

#include <gtest/gtest.h>

#include "shaders/shared/gaussian_cell.h"
#include "shaders/shared/preprocess.h"
#include "shaders/shared/registration.h"
#include "tests/support/layout.hpp"

namespace adit {
namespace {

using test::expect_layout;

TEST(KernelLayouts, PreprocessStructsAreTheSameInCppAndGlsl) {
  using gpu::InputCell;
  expect_layout<InputCell>("InputCell", {{"owner", offsetof(InputCell, owner)},
                                         {"inverted_first", offsetof(InputCell, inverted_first)},
                                         {"count", offsetof(InputCell, count)},
                                         {"sum_x", offsetof(InputCell, sum_x)},
                                         {"sum_y", offsetof(InputCell, sum_y)},
                                         {"sum_z", offsetof(InputCell, sum_z)}});
  using gpu::SweepCounters;
  expect_layout<SweepCounters>("SweepCounters",
                               {{"valid_points", offsetof(SweepCounters, valid_points)},
                                {"cloud_points", offsetof(SweepCounters, cloud_points)},
                                {"input_failures", offsetof(SweepCounters, input_failures)},
                                {"surface_failures", offsetof(SweepCounters, surface_failures)}});
  using gpu::DownsamplePush;
  expect_layout<DownsamplePush>("DownsamplePush",
                                {{"point_count", offsetof(DownsamplePush, point_count)},
                                 {"table_mask", offsetof(DownsamplePush, table_mask)},
                                 {"inverse_cell", offsetof(DownsamplePush, inverse_cell)},
                                 {"min_squared", offsetof(DownsamplePush, min_squared)},
                                 {"max_squared", offsetof(DownsamplePush, max_squared)}});
  expect_layout<gpu::CountPush>("CountPush",
                                {{"point_count", offsetof(gpu::CountPush, point_count)}});
  using gpu::EmitPush;
  expect_layout<EmitPush>("EmitPush",
                          {{"point_count", offsetof(EmitPush, point_count)},
                           {"cell", offsetof(EmitPush, cell)},
                           {"inverse_cell", offsetof(EmitPush, inverse_cell)},
                           {"inverse_surface_cell", offsetof(EmitPush, inverse_surface_cell)},
                           {"level_factor", offsetof(EmitPush, level_factor)},
                           {"surface_mask", offsetof(EmitPush, surface_mask)}});
  using gpu::SurfacePush;
  expect_layout<SurfacePush>("SurfacePush",
                             {{"inverse_surface_cell", offsetof(SurfacePush, inverse_surface_cell)},
                              {"level_factor", offsetof(SurfacePush, level_factor)},
                              {"surface_mask", offsetof(SurfacePush, surface_mask)}});
}

TEST(KernelLayouts, VoxelMapStructsAreTheSameInCppAndGlsl) {
  using gpu::GaussianCell;
  expect_layout<GaussianCell>("GaussianCell", {{"key", offsetof(GaussianCell, key)},
                                               {"count", offsetof(GaussianCell, count)},
                                               {"sum_x", offsetof(GaussianCell, sum_x)},
                                               {"sum_y", offsetof(GaussianCell, sum_y)},
                                               {"sum_z", offsetof(GaussianCell, sum_z)},
                                               {"xx", offsetof(GaussianCell, xx)},
                                               {"xy", offsetof(GaussianCell, xy)},
                                               {"xz", offsetof(GaussianCell, xz)},
                                               {"yy", offsetof(GaussianCell, yy)},
                                               {"yz", offsetof(GaussianCell, yz)},
                                               {"zz", offsetof(GaussianCell, zz)},
                                               {"unused0", offsetof(GaussianCell, unused0)}});
  // Read by kernels as three uvec4.
  EXPECT_EQ(sizeof(GaussianCell), 3 * sizeof(gpu::uvec4));
  using gpu::VoxelMapCounters;
  expect_layout<VoxelMapCounters>("VoxelMapCounters",
                                  {{"used_slots", offsetof(VoxelMapCounters, used_slots)},
                                   {"failures", offsetof(VoxelMapCounters, failures)},
                                   {"out_of_range", offsetof(VoxelMapCounters, out_of_range)},
                                   {"unused0", offsetof(VoxelMapCounters, unused0)}});
  using gpu::VoxelMapAddPush;
  expect_layout<VoxelMapAddPush>("VoxelMapAddPush",
                                 {{"pose", offsetof(VoxelMapAddPush, pose)},
                                  {"inverse_cell", offsetof(VoxelMapAddPush, inverse_cell)},
                                  {"table_mask", offsetof(VoxelMapAddPush, table_mask)},
                                  {"point_count", offsetof(VoxelMapAddPush, point_count)},
                                  {"sign", offsetof(VoxelMapAddPush, sign)}});
}

TEST(KernelLayouts, RegistrationStructsAreTheSameInCppAndGlsl) {
  using gpu::RegistrationState;
  expect_layout<RegistrationState>("RegistrationState",
                                   {{"groups_x", offsetof(RegistrationState, groups_x)},
                                    {"groups_y", offsetof(RegistrationState, groups_y)},
                                    {"groups_z", offsetof(RegistrationState, groups_z)},
                                    {"phase", offsetof(RegistrationState, phase)},
                                    {"iterations", offsetof(RegistrationState, iterations)},
                                    {"converged", offsetof(RegistrationState, converged)},
                                    {"failed", offsetof(RegistrationState, failed)},
                                    {"ticket", offsetof(RegistrationState, ticket)},
                                    {"damping", offsetof(RegistrationState, damping)},
                                    {"last_step", offsetof(RegistrationState, last_step)},
                                    {"unused0", offsetof(RegistrationState, unused0)},
                                    {"pose", offsetof(RegistrationState, pose)},
                                    {"system", offsetof(RegistrationState, system)}});
  using gpu::LinearizePush;
  expect_layout<LinearizePush>(
      "LinearizePush", {{"cell", offsetof(LinearizePush, cell)},
                        {"inverse_cell", offsetof(LinearizePush, inverse_cell)},
                        {"table_mask", offsetof(LinearizePush, table_mask)},
                        {"max_squared", offsetof(LinearizePush, max_squared)},
                        {"epsilon", offsetof(LinearizePush, epsilon)},
                        {"translation_epsilon", offsetof(LinearizePush, translation_epsilon)},
                        {"rotation_epsilon", offsetof(LinearizePush, rotation_epsilon)},
                        {"max_iterations", offsetof(LinearizePush, max_iterations)}});
}

TEST(KernelLayouts, StartOfAnAlignmentIsTheBeginningOfItsState) {
  using gpu::RegistrationStart;
  using gpu::RegistrationState;
  EXPECT_EQ(sizeof(RegistrationStart), offsetof(RegistrationState, pose));
  EXPECT_EQ(offsetof(RegistrationStart, groups_x), offsetof(RegistrationState, groups_x));
  EXPECT_EQ(offsetof(RegistrationStart, groups_y), offsetof(RegistrationState, groups_y));
  EXPECT_EQ(offsetof(RegistrationStart, groups_z), offsetof(RegistrationState, groups_z));
  EXPECT_EQ(offsetof(RegistrationStart, phase), offsetof(RegistrationState, phase));
  EXPECT_EQ(offsetof(RegistrationStart, iterations), offsetof(RegistrationState, iterations));
  EXPECT_EQ(offsetof(RegistrationStart, converged), offsetof(RegistrationState, converged));
  EXPECT_EQ(offsetof(RegistrationStart, failed), offsetof(RegistrationState, failed));
  EXPECT_EQ(offsetof(RegistrationStart, ticket), offsetof(RegistrationState, ticket));
  EXPECT_EQ(offsetof(RegistrationStart, damping), offsetof(RegistrationState, damping));
  EXPECT_EQ(offsetof(RegistrationStart, last_step), offsetof(RegistrationState, last_step));
  EXPECT_EQ(offsetof(RegistrationStart, unused0), offsetof(RegistrationState, unused0));
}

}  // namespace
}  // namespace adit
