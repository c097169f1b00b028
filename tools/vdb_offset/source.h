// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "request/request.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {

/// A mesh to offset, from a file or made by a scene, and what is in its way; or curves.
struct Source {
  std::optional<scene::Scene> scene;
  std::optional<io::MeshFile> file;
  std::optional<io::CurveFile> curves;
  std::vector<OpenCurve> closed;         ///< Those of the curves that have been closed (see --close),
  std::optional<Curves> as_closed;       ///< and all of them, if any were.
  Polygons obstacles;                    ///< From the command line; a scene's own are in the scene.
  std::optional<Polygons> to_fit;        ///< From the command line, as well;
  std::optional<Polygons> farfield;      ///< and this.
  std::vector<std::string> files_named;  ///< Files that those which were read name, read as well or not.

  PolygonView view() const {
    return file        ? file->polygons.view()
           : as_closed ? as_closed->view()
           : curves    ? curves->file.polygons.view()
                       : scene->shape.view();
  }
};

/// A source whose faces have been split, which stands in the place of the one that was read.
struct RefinedSource {
  Source source;                      ///< Its mesh alone.
  Refinement refinement;              ///< Of the mesh that was read.
  std::vector<std::uint32_t> vertex;  ///< Of each vertex of the source that of the refinement; empty: the same.
  std::vector<std::string> lost;      ///< What of the source it does not hold, in words.
};

/// Whether a file holds curves; one that cannot be opened is for the reader to report.
bool holds_curves(const std::string& path);

/// How curves are read for this request.
io::CurveReading curve_reading(const Request& request);

/// How CAD models are read for this request: by default to a hundredth of the least distance, between bounds.
io::CadReading cad_reading(const Request& request);

/// Prints what is wrong with a file that was read all the same.
void report_remarks(const io::MeshFile& file);

/// Reads INPUT, as curves or as a mesh, and the meshes beside it. \param progress of reading INPUT, as far as that is
/// known: of CAD models. \throw ReadError, InvalidInput
Source read_source(const Request& request, bool curves, const ProgressCallback& progress = {});

/// Makes the source with the faces of a refinement, a file of the same kind if it is one. \throw as io::refine_file()
RefinedSource refined_source(const Source& source, Refinement refinement);

/// Writes curves with other positions. In the format of the source its bytes stay, which know nothing of a curve that
/// has been closed: there its ends stand where the closed one has them.
void write_curves(const std::string& path, const Source& source, std::span<const Vec3d> positions,
                  const io::WriteOptions& options);

}  // namespace vdb_offset::tool
