// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::scene {

/// Where every reached vertex should be, in closed form.
struct VDB_OFFSET_API Answer {
  enum class Form {
    Sphere,  ///< At `radius` from the origin, on the ray from there.
    Box,     ///< The source vertex, clamped to the box of half sizes `half` around the origin.
    Torus,   ///< At `minor` from the circle of radius `major` around the z axis, on the ray from its centre.
    Shift,   ///< The source vertex plus `shift`.
    Ray,     ///< At the vertex's own distance from the source vertex, on the ray from the origin.
    Lift,    ///< Over the square of half side `radius` around the origin in the plane z = 0: see Answer::lifted.
    Under,   ///< On the ray of Ray, but no higher than z = `shift[2]`.
  };
  Form form = Form::Sphere;
  double radius = 0, major = 0, minor = 0;
  Vec3d half{0.0}, shift{0.0};

  /// `distance` is the vertex's own.
  Vec3d operator()(const Vec3d& source, double distance) const;

 private:
  /// Vertices inside the square go up by their distance. Vertices on its edge go as far outward within the plane if
  /// `shift` is (1, 1, 0), up if it is (0, 0, 1), and stay if it is zero. Vertices outside stay.
  Vec3d lifted(const Vec3d& source, double distance) const;
};

struct Expectations {
  std::optional<double> min_reached, max_reached;  ///< Share of the vertices in use.
  std::optional<double> max_position_error;        ///< World units; needs an answer.
  std::optional<Answer> answer;
  std::optional<double> max_face_error;    ///< Of 99 % of the faces' area, as a share of the distance.
  std::optional<double> min_gap, max_gap;  ///< Of a fit, world units: the least one that is left.
  std::optional<double> volume;            ///< Of a shell, world units^3.
  std::optional<double> max_volume_error;  ///< As a share of the volume; needs a volume.
};

/// A shape or a file, an offset, a grid, and expectations: `scenes/*.json`, described in the guide about scenes.
struct VDB_OFFSET_API Scene {
  std::string path, description;
  std::string mesh_path;  ///< Of a scene that names a file; else empty and `shape` holds the mesh.
  Polygons shape;
  GivenDistance distance;
  GridOptions grid;
  Solver solver = Solver::Closest;
  Collision collision = Collision::Limit;
  std::optional<Corners> corners;     ///< None: as OffsetOptions::corners without one.
  std::optional<double> miter_limit;  ///< See OffsetOptions::miter_limit, whose default holds without one.
  std::optional<double> taper;        ///< See OffsetOptions::taper, whose default holds without one.
  std::vector<std::uint8_t> only;     ///< See OffsetOptions::only.
  Border border = Border::Slide;
  Polygons obstacle;
  Polygons to_fit;       ///< Instead of `distance`: a mesh that the shape makes room for (see fit()).
  double clearance = 0;  ///< From the obstacle, or from the mesh to fit.
  bool shell = false;    ///< Source and offset are to be joined into one solid.
  Expectations expect;

  /// Puts the scene's own options, all but the distance, into `options`, which then refer to the scene.
  void set(OffsetOptions& options) const;
};

/// True of file names that end in .json.
VDB_OFFSET_API bool is_scene(const std::string& path);

/// \throw ReadError if the file cannot be opened, InvalidInput (file, key, what was expected) for what is no scene.
VDB_OFFSET_API Scene read_scene(const std::string& path);

/// The expectations that a result does not meet, in words; empty if it meets all.
VDB_OFFSET_API std::vector<std::string> unmet(const Expectations& expect, PolygonView source,
                                              const OffsetResult& result);
/// The expectations that the shell of a scene with a volume does not meet, in words: it must also be closed, manifold
/// and oriented, and must not cross itself.
VDB_OFFSET_API std::vector<std::string> unmet(const Expectations& expect, const ShellFacts& shell);

}  // namespace vdb_offset::scene
