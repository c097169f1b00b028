// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "source.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/offset.h"

/// Python's keywords as options of the library. Words and numbers mean what they mean to the command.
namespace vdb_offset::python {

/// The options of an offset, with what they refer to.
struct AskedOptions {
  OffsetOptions options;
  std::optional<MeshArrays> obstacles;
  std::vector<Vec2d> texture;  ///< Of each vertex: what u and v are in an expression. Empty: they are unknown.
  std::string vdb;             ///< A file for the field; empty: none.
};

/// \param keywords those that were given; see vdb_offset/_options.py for what each may be
/// \throw InvalidOption for a value that means nothing, InvalidInput for arrays that do not fit
AskedOptions asked_options(const py::dict& keywords, const Source& source);

/// A clearance: world units, or a text with a percentage of the mesh's diagonal. \throw InvalidOption
double clearance_of(const py::object& given, PolygonView mesh);

/// The options of a check: those of the offset, and a tolerance, or None.
CheckOptions check_options(const AskedOptions& asked, const py::object& tolerance);

/// The options of an iso-surface. \throw as asked_options()
IsoOptions iso_options(const py::dict& keywords);

}  // namespace vdb_offset::python
