// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

enum class CurveFormat {
  Text,  ///< Lines `x y` or `x y z`; a blank line ends a curve. Airfoils in Selig's or Lednicer's order are such files.
  Obj,   ///< `v` lines and `l` elements.
  Svg,   ///< Straight paths, polylines and polygons of a drawing.
};

/// The format that a file name's ending stands for as a file of curves (.dat .txt .xy .obj .svg, any case, also before
/// .gz or .zst), if it does. Whether an .obj holds curves is for holds_curves() to say.
VDB_OFFSET_API std::optional<CurveFormat> curve_format_of(std::string_view path);

/// What an SVG drawing's lines are, and where they stand in the file.
struct SvgLines {
  /// An element `path`, `polyline` or `polygon`. Its curves lie one behind the other.
  struct Shape {
    std::uint64_t begin, end;          ///< Bytes of its attribute `d` or `points`, without the quotes.
    bool is_path;                      ///< Else a list of points.
    std::array<double, 6> to_drawing;  ///< Of its points: x' = a x + c y + e, y' = b x + d y + f.
    std::size_t curves;
  };

  Curves curves;  ///< In the drawing's coordinates, y down as they are.
  std::vector<Shape> shapes;
  std::vector<Vec2d> own;            ///< Of each point: its coordinates in the shape's own system.
  std::vector<std::uint8_t> closed;  ///< Of each curve: 1 if a `Z` or a polygon closes it.
};

/// Curves as read, with all that is needed to write the same file again with other coordinates.
struct CurveFile {
  CurveFormat format = CurveFormat::Text;
  MeshFile file;        ///< Its polygons are the curves.
  bool planar = false;  ///< Points have two coordinates.
  SvgLines svg;         ///< Of a drawing: where they stand in the file, without the curves.
};

/// True for an OBJ without faces but with `l` elements, and for files with another of the endings. An OBJ is opened
/// for that; one that is compressed, or no regular file, is taken for a mesh. \throw ReadError
VDB_OFFSET_API bool holds_curves(const std::string& path);

/// Reads curves. Text: a first line that is not two or three numbers is a title; behind # is a comment. A curve is
/// closed if it ends where it begins, or if a comment before its first point holds the word "closed". With a title and,
/// on the first line of numbers, the counts of the two lists that follow, each from the nose on, it is an airfoil in
/// Lednicer's order: one curve, from the end of the first list over the nose to the end of the second. OBJ: an `l`
/// element is a curve. SVG: see parse_svg(). \throw ReadError if the file cannot be opened, InvalidInput (file, line,
/// what was expected, what was found).
VDB_OFFSET_API CurveFile read_curves(const std::string& path);

/// Reads curves as read_curves() does from bytes in memory; `name` is for messages.
VDB_OFFSET_API CurveFile parse_curves(const std::string& name, CurveFormat format, std::string bytes);

/// Writes the curves with other positions to `path`, as write_mesh() does: in the source's own format every byte stays
/// but for the coordinates of points that moved; in a drawing for the shapes that they are part of.
/// \pre one position a point. \throw InvalidInput for an unknown ending, WriteError, ReadError.
VDB_OFFSET_API void write_curves(const std::string& path, const CurveFile& source, std::span<const Vec3d> positions,
                                 const WriteOptions& options = {});

/// Writes curves that come from no file: line elements in an OBJ, paths in an SVG, or text. \throw as the other one
VDB_OFFSET_API void write_curves(const std::string& path, CurvesView curves, const WriteOptions& options = {});

/// The precision of coordinates that write_curves() writes.
VDB_OFFSET_API Precision precision_of_curves(const WriteOptions& options);

}  // namespace vdb_offset::io
