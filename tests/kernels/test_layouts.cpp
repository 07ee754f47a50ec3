// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Every struct of shaders/shared that kernels use: C++ and GLSL agree on each member's place.
#include <cstddef>

#include <gtest/gtest.h>

#include "adit/shaders/shared/deskew.h"
#include "adit/shaders/shared/free_space.h"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/limit_probes.h"
#include "adit/shaders/shared/preprocess.h"
#include "adit/shaders/shared/registration.h"
#include "adit/shaders/shared/submap.h"
#include "adit/tests/support/layout.hpp"

namespace adit {
namespace {

using test::expect_layout;

TEST(KernelLayouts, PreprocessStructsAreTheSameInCppAndGlsl) {
  using gpu::InputCell;
  expect_layout<InputCell>("InputCell", {{"owner", offsetof(InputCell, owner)},
                                         {"count", offsetof(InputCell, count)},
                                         {"sum_x", offsetof(InputCell, sum_x)},
                                         {"sum_y", offsetof(InputCell, sum_y)},
                                         {"sum_z", offsetof(InputCell, sum_z)},
                                         {"carries", offsetof(InputCell, carries)},
                                         {"unused0", offsetof(InputCell, unused0)},
                                         {"unused1", offsetof(InputCell, unused1)}});
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

TEST(KernelLayouts, DeskewStructsAreTheSameInCppAndGlsl) {
  // The shader reads knots as two vec4 each.
  EXPECT_EQ(offsetof(gpu::DeskewKnot, rotation), 0U);
  EXPECT_EQ(offsetof(gpu::DeskewKnot, translation), sizeof(gpu::vec4));
  EXPECT_EQ(sizeof(gpu::DeskewKnot), 2 * sizeof(gpu::vec4));
  using gpu::DeskewPush;
  expect_layout<DeskewPush>("DeskewPush", {{"point_count", offsetof(DeskewPush, point_count)},
                                           {"knots", offsetof(DeskewPush, knots)},
                                           {"first_time", offsetof(DeskewPush, first_time)},
                                           {"per_second", offsetof(DeskewPush, per_second)},
                                           {"min_squared", offsetof(DeskewPush, min_squared)},
                                           {"max_squared", offsetof(DeskewPush, max_squared)}});
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
                                               {"surfaces", offsetof(GaussianCell, surfaces)}});
  // Read by kernels as three uvec4.
  EXPECT_EQ(sizeof(GaussianCell), 3 * sizeof(gpu::uvec4));
  using gpu::VoxelMapCounters;
  expect_layout<VoxelMapCounters>("VoxelMapCounters",
                                  {{"used_slots", offsetof(VoxelMapCounters, used_slots)},
                                   {"failures", offsetof(VoxelMapCounters, failures)},
                                   {"out_of_range", offsetof(VoxelMapCounters, out_of_range)},
                                   {"crowded", offsetof(VoxelMapCounters, crowded)}});
  using gpu::VoxelMapAddPush;
  expect_layout<VoxelMapAddPush>("VoxelMapAddPush",
                                 {{"pose", offsetof(VoxelMapAddPush, pose)},
                                  {"inverse_cell", offsetof(VoxelMapAddPush, inverse_cell)},
                                  {"table_mask", offsetof(VoxelMapAddPush, table_mask)},
                                  {"point_count", offsetof(VoxelMapAddPush, point_count)},
                                  {"sign", offsetof(VoxelMapAddPush, sign)}});
}

TEST(KernelLayouts, FreeSpaceStructsAreTheSameInCppAndGlsl) {
  using gpu::SpaceVoxel;
  expect_layout<SpaceVoxel>("SpaceVoxel", {{"key", offsetof(SpaceVoxel, key)},
                                           {"normal", offsetof(SpaceVoxel, normal)},
                                           {"seen", offsetof(SpaceVoxel, seen)},
                                           {"through", offsetof(SpaceVoxel, through)},
                                           {"seen_by", offsetof(SpaceVoxel, seen_by)},
                                           {"through_by", offsetof(SpaceVoxel, through_by)}});
  using gpu::SpaceRay;
  expect_layout<SpaceRay>("SpaceRay", {{"hit_x", offsetof(SpaceRay, hit_x)},
                                       {"hit_y", offsetof(SpaceRay, hit_y)},
                                       {"hit_z", offsetof(SpaceRay, hit_z)},
                                       {"from_x", offsetof(SpaceRay, from_x)},
                                       {"from_y", offsetof(SpaceRay, from_y)},
                                       {"from_z", offsetof(SpaceRay, from_z)},
                                       {"step_x", offsetof(SpaceRay, step_x)},
                                       {"step_y", offsetof(SpaceRay, step_y)},
                                       {"step_z", offsetof(SpaceRay, step_z)},
                                       {"samples", offsetof(SpaceRay, samples)},
                                       {"direction", offsetof(SpaceRay, direction)}});
  using gpu::SpacePush;
  expect_layout<SpacePush>("SpacePush", {{"begin", offsetof(SpacePush, begin)},
                                         {"ray_count", offsetof(SpacePush, ray_count)},
                                         {"submap", offsetof(SpacePush, submap)},
                                         {"table_mask", offsetof(SpacePush, table_mask)}});
}

TEST(KernelLayouts, RegistrationStructsAreTheSameInCppAndGlsl) {
  using gpu::RegistrationJob;
  expect_layout<RegistrationJob>("RegistrationJob",
                                 {{"source_begin", offsetof(RegistrationJob, source_begin)},
                                  {"source_count", offsetof(RegistrationJob, source_count)},
                                  {"target_begin", offsetof(RegistrationJob, target_begin)},
                                  {"table_mask", offsetof(RegistrationJob, table_mask)},
                                  {"groups", offsetof(RegistrationJob, groups)},
                                  {"cell", offsetof(RegistrationJob, cell)},
                                  {"inverse_cell", offsetof(RegistrationJob, inverse_cell)},
                                  {"max_squared", offsetof(RegistrationJob, max_squared)},
                                  {"wide_squared", offsetof(RegistrationJob, wide_squared)},
                                  {"wide_iterations", offsetof(RegistrationJob, wide_iterations)},
                                  {"score_weight", offsetof(RegistrationJob, score_weight)},
                                  {"score_exponent", offsetof(RegistrationJob, score_exponent)},
                                  {"viewpoint", offsetof(RegistrationJob, viewpoint)},
                                  {"unused0", offsetof(RegistrationJob, unused0)}});
  using gpu::RegistrationProgress;
  expect_layout<RegistrationProgress>("RegistrationProgress",
                                      {{"phase", offsetof(RegistrationProgress, phase)},
                                       {"iterations", offsetof(RegistrationProgress, iterations)},
                                       {"converged", offsetof(RegistrationProgress, converged)},
                                       {"failed", offsetof(RegistrationProgress, failed)},
                                       {"ticket", offsetof(RegistrationProgress, ticket)},
                                       {"factor", offsetof(RegistrationProgress, factor)},
                                       {"most_factor", offsetof(RegistrationProgress, most_factor)},
                                       {"last_step", offsetof(RegistrationProgress, last_step)}});
  using gpu::RegistrationPass;
  expect_layout<RegistrationPass>("RegistrationPass",
                                  {{"groups_x", offsetof(RegistrationPass, groups_x)},
                                   {"groups_y", offsetof(RegistrationPass, groups_y)},
                                   {"groups_z", offsetof(RegistrationPass, groups_z)},
                                   {"remaining", offsetof(RegistrationPass, remaining)}});
  using gpu::RegistrationHeader;
  expect_layout<RegistrationHeader>("RegistrationHeader",
                                    {{"iterate", offsetof(RegistrationHeader, iterate)},
                                     {"assess", offsetof(RegistrationHeader, assess)},
                                     {"constrained", offsetof(RegistrationHeader, constrained)},
                                     {"reassess", offsetof(RegistrationHeader, reassess)}});
  using gpu::RegistrationState;
  expect_layout<RegistrationState>("RegistrationState",
                                   {{"pose", offsetof(RegistrationState, pose)},
                                    {"guess", offsetof(RegistrationState, guess)},
                                    {"prior", offsetof(RegistrationState, prior)},
                                    {"system", offsetof(RegistrationState, system)},
                                    {"directions", offsetof(RegistrationState, directions)},
                                    {"support", offsetof(RegistrationState, support)},
                                    {"share", offsetof(RegistrationState, share)},
                                    {"constrained", offsetof(RegistrationState, constrained)},
                                    {"unused0", offsetof(RegistrationState, unused0)}});
  using gpu::RegistrationPush;
  expect_layout<RegistrationPush>(
      "RegistrationPush", {{"epsilon", offsetof(RegistrationPush, epsilon)},
                           {"fictitious", offsetof(RegistrationPush, fictitious)},
                           {"robust_width", offsetof(RegistrationPush, robust_width)},
                           {"translation_epsilon", offsetof(RegistrationPush, translation_epsilon)},
                           {"rotation_epsilon", offsetof(RegistrationPush, rotation_epsilon)},
                           {"max_iterations", offsetof(RegistrationPush, max_iterations)},
                           {"group_stride", offsetof(RegistrationPush, group_stride)},
                           {"weak_share", offsetof(RegistrationPush, weak_share)},
                           {"serves", offsetof(RegistrationPush, serves)}});
  using gpu::VoxelMapFinishPush;
  expect_layout<VoxelMapFinishPush>(
      "VoxelMapFinishPush", {{"cell", offsetof(VoxelMapFinishPush, cell)},
                             {"slots", offsetof(VoxelMapFinishPush, slots)},
                             {"min_points", offsetof(VoxelMapFinishPush, min_points)},
                             {"least_ratio", offsetof(VoxelMapFinishPush, least_ratio)},
                             {"least_squared", offsetof(VoxelMapFinishPush, least_squared)}});
}

TEST(KernelLayouts, SubmapStructsAreTheSameInCppAndGlsl) {
  using gpu::MergeCell;
  expect_layout<MergeCell>("MergeCell",
                           {{"key", offsetof(MergeCell, key)},
                            {"count", offsetof(MergeCell, count)},
                            {"sum_x", offsetof(MergeCell, sum_x)},
                            {"sum_y", offsetof(MergeCell, sum_y)},
                            {"sum_z", offsetof(MergeCell, sum_z)},
                            {"inverted_nearest", offsetof(MergeCell, inverted_nearest)}});
  using gpu::MergeCounters;
  expect_layout<MergeCounters>("MergeCounters",
                               {{"used_slots", offsetof(MergeCounters, used_slots)},
                                {"failures", offsetof(MergeCounters, failures)},
                                {"out_of_range", offsetof(MergeCounters, out_of_range)},
                                {"unused0", offsetof(MergeCounters, unused0)}});
  using gpu::MergePush;
  expect_layout<MergePush>("MergePush", {{"pose", offsetof(MergePush, pose)},
                                         {"inverse_cell", offsetof(MergePush, inverse_cell)},
                                         {"table_mask", offsetof(MergePush, table_mask)},
                                         {"begin", offsetof(MergePush, begin)},
                                         {"point_count", offsetof(MergePush, point_count)},
                                         {"sweep", offsetof(MergePush, sweep)}});
  using gpu::SubmapSurfacePush;
  expect_layout<SubmapSurfacePush>(
      "SubmapSurfacePush",
      {{"point_count", offsetof(SubmapSurfacePush, point_count)},
       {"inverse_surface_cell", offsetof(SubmapSurfacePush, inverse_surface_cell)},
       {"level_factor", offsetof(SubmapSurfacePush, level_factor)},
       {"surface_mask", offsetof(SubmapSurfacePush, surface_mask)}});
}

TEST(KernelLayouts, LimitProbeStructsAreTheSameInCppAndGlsl) {
  expect_layout<gpu::LimitCopyPush>("LimitCopyPush",
                                    {{"count", offsetof(gpu::LimitCopyPush, count)}});
  using gpu::LimitMultiplyAddPush;
  expect_layout<LimitMultiplyAddPush>("LimitMultiplyAddPush",
                                      {{"rounds", offsetof(LimitMultiplyAddPush, rounds)},
                                       {"factor", offsetof(LimitMultiplyAddPush, factor)},
                                       {"addend", offsetof(LimitMultiplyAddPush, addend)}});
  using gpu::LimitGatherPush;
  expect_layout<LimitGatherPush>("LimitGatherPush", {{"count", offsetof(LimitGatherPush, count)},
                                                     {"mask", offsetof(LimitGatherPush, mask)}});
  using gpu::LimitScatterPush;
  expect_layout<LimitScatterPush>("LimitScatterPush", {{"count", offsetof(LimitScatterPush, count)},
                                                       {"mask", offsetof(LimitScatterPush, mask)}});
}

}  // namespace
}  // namespace adit
