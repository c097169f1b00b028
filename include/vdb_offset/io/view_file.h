// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset::io {

/// What became of each vertex of a mesh.
struct VertexStates {
  std::span<const VertexState> state;
  std::span<const double> achieved;  ///< World units, as is the target.
  const Distances& target;           ///< Negative is inward.
};

/// What else of a result a viewer can show.
struct ResultFaces {
  std::span<const float> error;       ///< As OffsetResult::face_errors; may be empty.
  const WallNames* groups = nullptr;  ///< What the source calls its faces.
  bool are_curves = false;            ///< The "faces" are plane curves.
  std::span<const FaceFault> fault;   ///< As OffsetResult::face_faults; may be empty.
};

/// True of the endings that write_states() knows: .csv, .ply and .vtp.
VDB_OFFSET_API bool is_states_file(const std::string& path);

/// Writes one line or one vertex for each of the mesh's: CSV `vertex,state,target,achieved`; or the mesh itself, which
/// a viewer can colour: PLY (binary, vertex properties state, in the order of VertexState, target and achieved), or
/// VTK's .vtp (point data share, state, achieved and target, cell data face_error, fault and group, as far as they are
/// known; words for states, faults and groups as field data state_words, fault_words and group_words). share is
/// achieved by target, NaN where the target is 0. \throw WriteError
VDB_OFFSET_API void write_states(const std::string& path, PolygonView mesh, const VertexStates& states,
                                 const ResultFaces& faces = {});

/// True of the ending that write_path_lines() knows: .vtp.
VDB_OFFSET_API bool is_lines_file(const std::string& path);

/// Writes the paths of vertices (OffsetResult::paths) as lines, with cell data state, achieved, target and vertex.
/// Vertices that stay have none. \throw WriteError
VDB_OFFSET_API void write_path_lines(const std::string& path, const std::vector<std::vector<Vec3d>>& paths,
                                     const VertexStates& states);

/// A surface that a page shows with the source: the source's vertices and faces in other places, or a mesh of its own,
/// of which nothing is measured. Spans of what is not known are empty.
struct PageSurface {
  std::string name;                                   ///< What the page calls it.
  std::function<Vec3d(std::size_t vertex)> position;  ///< World units; only asked for what is shown.
  std::span<const VertexState> states;
  std::span<const double> achieved;    ///< World units, as is the target.
  const Distances* target = nullptr;   ///< Negative is inward.
  std::span<const double> share;       ///< Of what was asked; it is counted from the distances where those are known.
  std::span<const float> face_errors;  ///< As OffsetResult::face_errors.
  std::span<const FaceFault> face_faults;  ///< As OffsetResult::face_faults.
  std::optional<PolygonView> own;          ///< A mesh that is not the source's; then all but the name is unused.
};

/// What a page shows of a run. Refers to what it is made of.
struct Page {
  std::string title;    ///< Of the run: the name of its source.
  std::string command;  ///< As it was typed.
  std::string report;   ///< JSON text; empty: there is none.
  PolygonView source;
  bool are_curves = false;              ///< The "faces" are plane curves, and the surfaces too.
  bool are_layers = false;              ///< The surfaces lie one on the other, and can be peeled off.
  std::vector<PageSurface> surfaces;    ///< From the source outward; none: the source is shown alone.
  const WallNames* groups = nullptr;    ///< What the source calls its faces.
  std::span<const float> cell_quality;  ///< Of cells between the surfaces: scaled Jacobians.
  std::string unit;                     ///< Of lengths, as in "mm"; empty: not known.
  int up = 2;                           ///< The axis that is up, from 0.
  std::vector<std::string> remarks;     ///< What the page has to say of what it does not show.
  /// More triangles than this are shown by fewer, source and surfaces together. So many take 7 MB, and a second to draw
  /// on two cores without a graphics card.
  std::size_t most_triangles = 600'000;
};

/// \throw InvalidOption if the library is built without the viewer that pages are made with
VDB_OFFSET_API void require_pages(const std::string& path);

/// Writes one HTML file that shows a run in a browser, without a network: source and surfaces to be turned, coloured by
/// what became of them, and the figures. Where there are more triangles than are shown, vertices are clustered; each
/// that is left is one of the mesh's own, with its number, and of those in one place the one that is farthest from what
/// was asked. Figures are of all vertices. The bytes do not depend on the number of threads.
/// \throw WriteError; InvalidOption as require_pages()
VDB_OFFSET_API void write_page(const std::string& path, const Page& page);

}  // namespace vdb_offset::io
