// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

enum class CurveFormat {
  Text,  ///< Lines `x y` or `x y z`; a blank line ends a curve. Airfoils in Selig's or Lednicer's order are such files.
  Obj,   ///< `v` lines and `l` elements.
  Svg,   ///< Paths and other shapes of a drawing.
  Dxf,   ///< Entities of a drawing, in ASCII.
};

/// The format that a file name's ending stands for as a file of curves (.dat .txt .xy .obj .svg .dxf, any case, also
/// before .gz or .zst), if it does. Whether an .obj holds curves is for holds_curves() to say.
VDB_OFFSET_API std::optional<CurveFormat> curve_format_of(std::string_view path);

struct SvgDrawing;
struct DxfDrawing;

/// How curves are read.
struct VDB_OFFSET_API CurveReading {
  /// How far straight segments may be from the curved ones of a drawing that they stand for: a share of the diagonal of
  /// the box around its shapes, or, where the share is 0, a length in world units.
  double flatten_share = kFlattenShare, flatten_length = 0;
  /// A hundredth of a millimetre on a sheet of a metre: less than laser cutters repeat. It does not depend on the
  /// distance, so that all offsets of a drawing have the same points.
  static constexpr double kFlattenShare = 1e-5;
};

/// Curves as read, with all that is needed to write the same file again with other coordinates.
struct CurveFile {
  CurveFormat format = CurveFormat::Text;
  MeshFile file;                          ///< Its polygons are the curves.
  bool planar = false;                    ///< Points have two coordinates.
  std::shared_ptr<const SvgDrawing> svg;  ///< Of an SVG drawing: where the curves stand in the file.
  std::shared_ptr<const DxfDrawing> dxf;  ///< Of a DXF drawing, likewise.
  std::size_t flattened_shapes = 0;       ///< Shapes of a drawing with curved segments, which are straight ones here,
  double flattened_to = 0;                ///< no farther than this from them, world units.
};

/// True for an OBJ without faces but with `l` elements, and for files with another of the endings. An OBJ is opened
/// for that; one that is compressed, or no regular file, is taken for a mesh. \throw ReadError
VDB_OFFSET_API bool holds_curves(const std::string& path);

/// The length of the unit of a file's coordinates in micrometres, if it is a drawing that states it: a DXF file with a
/// unit in its header, which is all that is read, or an SVG drawing by its width, height and viewBox. \throw ReadError,
/// InvalidInput as read_curves()
VDB_OFFSET_API std::optional<double> unit_of_curves(const std::string& path);

/// Reads curves. Text: a first line that is not two or three numbers is a title; behind # is a comment. A curve is
/// closed if it ends where it begins, or if a comment before its first point holds the word "closed". With a title and,
/// on the first line of numbers, the counts of the two lists that follow, each from the nose on, it is an airfoil in
/// Lednicer's order: one curve, from the end of the first list over the nose to the end of the second. OBJ: an `l`
/// element is a curve. SVG: the outlines of shapes, as they are drawn, in the coordinates of the outermost element;
/// curved segments are flattened. DXF: lines, polylines, arcs, circles, ellipses and splines, also as INSERT shows
/// them; curved ones are flattened, and ends that are one but for rounding are joined. \throw ReadError if the file
/// cannot be opened, InvalidInput (file, line, what was expected, what was found).
VDB_OFFSET_API CurveFile read_curves(const std::string& path, const CurveReading& how = {});

/// Reads curves as read_curves() does from bytes in memory; `name` is for messages.
VDB_OFFSET_API CurveFile parse_curves(const std::string& name, CurveFormat format, std::string bytes,
                                      const CurveReading& how = {});

/// Writes the curves with other positions to `path`, as write_mesh() does: in the source's own format every byte stays
/// but for the coordinates of points that moved; in a drawing for the shapes that they are part of: curved ones and
/// rectangles become paths in their places, and, if any shape moved, each `use` a group of what it shows. In a DXF file
/// curved entities become polylines, and an INSERT what it shows, if any of it moved.
/// \pre one position a point. \throw InvalidInput for an unknown ending, WriteError, ReadError.
VDB_OFFSET_API void write_curves(const std::string& path, const CurveFile& source, std::span<const Vec3d> positions,
                                 const WriteOptions& options = {});

/// Writes curves that come from no file: line elements in an OBJ, paths in an SVG, polylines in a
/// DXF, or text. \throw as the other one
VDB_OFFSET_API void write_curves(const std::string& path, CurvesView curves, const WriteOptions& options = {});

/// The precision of coordinates that write_curves() writes of curves from a file: points that do not move keep theirs
/// in text and OBJ of the same format.
VDB_OFFSET_API Precision precision_of_curves(const std::string& path, const CurveFile& source,
                                             const WriteOptions& options);

}  // namespace vdb_offset::io
