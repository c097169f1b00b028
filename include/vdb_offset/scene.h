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

/// A distance as users write it: world units ("0.1"), or a share of the bounding-box diagonal of the vertices in
/// use ("1.5%"); or an expression that tells each vertex its own.
struct VDB_OFFSET_API Distance {
  double value = 0;
  bool percent = false;
  std::optional<DistanceExpression> expression;  ///< If set, value and percent do not count.

  double in_world_units(double diagonal) const;
};
/// \throw InvalidInput unless the text is a finite number, with or without a percent sign behind it.
VDB_OFFSET_API Distance parse_distance(const std::string& text);
/// Parses a number as parse_distance() does, or else an expression. \throw InvalidExpression
VDB_OFFSET_API Distance parse_distance_or_expression(const std::string& text);

/// The distances of a mesh's vertices, or of curves' points. `normals_of` and `texture_of` are called only by an
/// expression that uses normals or texture coordinates.
/// \throw InvalidInput, see DistanceExpression
VDB_OFFSET_API Distances distances_of(const Distance& distance, PolygonView mesh,
                                      const std::function<std::vector<Vec3d>()>& normals_of,
                                      const std::function<std::vector<Vec2d>()>& texture_of);

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
  Distance distance;
  GridOptions grid;
  Solver solver = Solver::Closest;
  Collision collision = Collision::Limit;
  Corners corners = Corners::Round;
  std::optional<double> miter_limit;  ///< See OffsetOptions::miter_limit, whose default holds without one.
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

// Procedural meshes, faces counter-clockwise seen from outside. Lengths in world units. Every count is the number
// of faces along that direction. All throw InvalidInput for a count below its least or a length that is not positive.

/// Icosahedron with its triangles split in four `subdivisions` times, on a sphere: 10 * 4^n + 2 vertices.
VDB_OFFSET_API Polygons icosphere(double radius, int subdivisions);
/// Quads between rings of latitude, triangles at the poles (on the z axis).
VDB_OFFSET_API Polygons uv_sphere(double radius, int segments, int rings);
/// Open: the upper half of uv_sphere(), with a circle in the plane z = 0 as its border.
VDB_OFFSET_API Polygons hemisphere(double radius, int segments, int rings);
/// Axis-aligned box centred at the origin, `divisions` faces along each edge: quads, or triangles by pairs.
VDB_OFFSET_API Polygons box(const Vec3d& size, int divisions, bool triangles);
/// Around the z axis: `major` is the radius of the circle of centres, `minor` that of the tube.
VDB_OFFSET_API Polygons torus(double major, double minor, int segments, int sides);
/// Along z, closed by flat caps of `rings` rings.
VDB_OFFSET_API Polygons cylinder(double radius, double height, int segments, int stacks, int rings);
/// Along z, closed: a round block with a hole from above; the hole has its floor at z = 0 and its mouth at z = `depth`;
/// the block is `wall` thick around and below it.
VDB_OFFSET_API Polygons socket(double radius, double depth, double wall, int segments, int stacks);
/// Two square boxes, one above the other, `gap` apart along z; the gap is centred at z = 0.
VDB_OFFSET_API Polygons plates(double width, double thickness, double gap, int divisions);
/// Open: two rectangles that meet along the y axis and enclose `angle` degrees, opening upwards; seen from inside.
VDB_OFFSET_API Polygons wedge(double angle, double length, double width, int divisions);
/// Open: three squares in the coordinate planes that meet at the origin, seen from x, y, z > 0.
VDB_OFFSET_API Polygons room_corner(double side, int divisions);
/// Open: a square duct along x, `inlet` wide until a third of its length, `outlet` from two thirds on; seen from
/// inside, as the flow does.
VDB_OFFSET_API Polygons diffuser(double inlet, double outlet, double length, int divisions);
/// NACA four-digit section in x and z with a sharp trailing edge, extruded along y, closed at both ends.
VDB_OFFSET_API Polygons naca_wing(const std::string& digits, double chord, double span, int points, int stacks);
/// Straight-flanked gear with a bore, around the z axis.
VDB_OFFSET_API Polygons gear(int teeth, double root_radius, double tip_radius, double bore_radius, double thickness,
                             int stacks);
/// Icosphere with waves of the given amplitude; the seed decides their directions and phases, on any machine alike.
VDB_OFFSET_API Polygons bumpy_sphere(double radius, double amplitude, double frequency, unsigned seed,
                                     int subdivisions);
/// A box with a box-shaped cavity inside, walls `wall` thick.
VDB_OFFSET_API Polygons hollow_box(double side, double wall, int divisions);
/// Open: a square patch over x and y with height amplitude * sin(2 pi x / side) * sin(2 pi y / side).
VDB_OFFSET_API Polygons patch(double side, double amplitude, int divisions);

}  // namespace vdb_offset::scene
