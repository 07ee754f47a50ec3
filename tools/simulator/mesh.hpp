// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Triangle meshes and the shapes they are put together from. Metres.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// How a surface answers light at a lidar's wavelength.
enum class Material : uint8_t {
  concrete,
  rock,
  asphalt,
  soil,
  grass,
  bark,
  leaves,
  wood,
  plaster,
  paint,
  metal,
  dark,
  sign,
  glass,
};

struct Optics {
  float reflectivity = 0.5F;       ///< for a Lambertian surface, 0 to 1
  float transmission = 0.0F;       ///< probability that a pulse goes through, for glass
  std::array<uint8_t, 3> color{};  ///< for pictures
};
Optics optics_of(Material material);

struct Triangle {
  std::array<uint32_t, 3> corners{};
  Material material = Material::concrete;
};

/// One object in a mesh: consecutive vertices, and the consecutive triangles between them.
struct MeshPart {
  std::string label{};  ///< "desk", "parked car"
  std::size_t first_vertex = 0;
  std::size_t vertices = 0;
  std::size_t first_triangle = 0;
  std::size_t triangles = 0;
};

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
  std::vector<MeshPart> movable{};  ///< what people move between two days, in order
};

/// What `add` adds to the mesh is one object that people move.
void add_movable(Mesh& mesh, std::string label, const std::function<void()>& add);

/// A surface over a grid: `at(u, v)` for u = 0 .. columns and v = 0 .. rows gives its vertices.
void add_patch(Mesh& mesh, int columns, int rows, Material material,
               const std::function<Eigen::Vector3d(int, int)>& at);

/// A plane quadrangle, corners in turn.
void add_quad(Mesh& mesh, const std::array<Eigen::Vector3d, 4>& corners, Material material);

/// A box with its own axes. `half_size` along them.
void add_box(Mesh& mesh, const Eigen::Isometry3d& T_world_box, const Eigen::Vector3d& half_size,
             Material material);

/// A box along the world's axes between two corners.
void add_block(Mesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
               Material material);

/// A tube around the line between two points, with its ends closed; it may taper.
struct Rod {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
  double radius_from = 0.1;
  double radius_to = 0.1;
  int sides = 10;
};
void add_rod(Mesh& mesh, const Rod& rod, Material material);

/// An ellipsoid whose surface is uneven by up to `roughness` of its radii, drawn from `seed`.
struct Blob {
  Eigen::Vector3d center;
  Eigen::Vector3d radii;
  double roughness = 0.0;
  uint64_t seed = 0;
  int sides = 10;
};
void add_blob(Mesh& mesh, const Blob& blob, Material material);

/// Smooth noise in [-1, 1] with features of size 1, the same everywhere for the same seed.
double value_noise(const Eigen::Vector3d& at, uint64_t seed);

}  // namespace adit
