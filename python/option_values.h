// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "vdb_offset/check.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/offset.h"

/// Python's keywords as options of the library. Words and numbers mean what they mean to the command.
namespace vdb_offset::python {

/// The options of an offset, with what they refer to.
struct AskedOptions {
  OffsetOptions options;
  std::optional<MeshArrays> obstacles;
};

/// \param keywords those that were given; see vdb_offset/__init__.py for what each may be
/// \throw InvalidOption for a value that means nothing, InvalidInput for arrays that do not fit
AskedOptions asked_options(const py::dict& keywords, const MeshArrays& mesh);

/// A tolerance as a share of the distance and a length, one of which is 0: a number in world units, or a text with a
/// percentage. \throw InvalidInput
std::pair<double, double> tolerance_of(const py::object& tolerance);

/// Lets distances along z be `distance_z`, and those in the plane across it `distance`, if the keyword is given: both
/// of one sign, as distances_of() has them. \throw InvalidOption
void measure_by_axis(const py::dict& keywords, const Distances& distance, PolygonView mesh, Metric& metric);

/// The options of a check: those of the offset, and a tolerance.
CheckOptions check_options(const AskedOptions& asked, const py::dict& keywords);

/// The options of an iso-surface. \throw as asked_options()
IsoOptions iso_options(const py::dict& keywords);

/// A distance: a number, an array with one for each vertex, or a text: a number, a percentage of the diagonal, or an
/// expression. \throw InvalidOption, InvalidInput
Distances distances_of(const py::object& distance, PolygonView mesh, bool curves, const OffsetOptions& options);

}  // namespace vdb_offset::python
