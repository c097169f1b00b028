// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

// Procedural meshes, faces counter-clockwise seen from outside. Lengths in world units. Every count is the number
// of faces along that direction. All throw InvalidInput for a count below its least or a length that is not positive.
namespace vdb_offset::shapes {

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

}  // namespace vdb_offset::shapes
