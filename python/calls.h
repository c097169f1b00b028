// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>

#include "source.h"

/// The calls of the module. Keywords are those that were given, by name (see vdb_offset/_options.py); `progress` is a
/// callback or None. Results are dictionaries of arrays that own what they show.
namespace vdb_offset::python {

/// The offsets of a mesh, or of curves, to each of some distances.
py::list offset_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& distances,
                       const py::dict& keywords, const py::object& progress);
/// \param other a pair of vertices and faces
py::dict fit_arrays(const py::object& vertices, const py::object& faces, const py::tuple& other,
                    const py::object& clearance, const py::dict& keywords, const py::object& progress);
py::dict refined_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                        const py::object& tolerance, std::size_t most_faces, bool ridges_only, const py::dict& keywords,
                        const py::object& progress);

/// \param distance, tolerance each may be None
py::dict check_arrays(Input input, const py::object& vertices, const py::object& faces, const py::object& positions,
                      const py::object& distance, const py::object& tolerance, const py::dict& keywords,
                      const py::object& progress);

/// The shells of each of some distances. \param inner the distance of the inner skin, or None
py::list shell_arrays(const py::object& vertices, const py::object& faces, const py::list& distances,
                      const py::object& inner, const py::dict& keywords, const py::object& progress);
py::dict iso_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                    const py::dict& keywords, const py::object& progress);
/// \param inner the distance of the cavity, or None
py::dict iso_shell_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                          const py::object& inner, const py::dict& keywords, const py::object& progress);

/// The heights of layers, by what is known of them: `count`, `growth`, `first`, `total` and `last`, of which some are
/// None. Each is a number, or an array with one for each vertex.
py::list plan(Input input, const py::object& vertices, const py::object& faces, const py::dict& known,
              const py::dict& keywords);

/// Layers, filled with cells.
py::dict layer_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& heights,
                      const py::dict& keywords, const py::object& progress);
/// Layers as a structured block.
py::dict block_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& heights,
                      const py::dict& keywords, const py::object& progress);

}  // namespace vdb_offset::python
