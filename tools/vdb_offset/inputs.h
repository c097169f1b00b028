#pragma once

#include <optional>
#include <vector>

#include "args.h"
#include "vdb_offset/curves.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {

/// A mesh to offset, from a file or made by a scene, and what is in its way; or curves.
struct Source {
  std::optional<scene::Scene> scene;
  std::optional<io::MeshFile> file;
  std::optional<io::CurveFile> curves;
  std::vector<OpenCurve> closed;    ///< Those of the curves that have been closed (see --close),
  std::optional<Curves> as_closed;  ///< and all of them, if any were.
  Polygons obstacles;
  std::optional<Polygons> to_fit;

  PolygonView view() const {
    return file        ? file->polygons.view()
           : as_closed ? as_closed->view()
           : curves    ? curves->file.polygons.view()
                       : scene->shape.view();
  }
};

/// Prints what is wrong with a file that was read all the same.
void tell_remarks(const io::MeshFile& file);

Source read_source(const Arguments& args);

/// Curves with other positions. In the format of the source its bytes stay, which know nothing of a curve that has been
/// closed: there its ends stand where the closed one has them.
void write_curves(const std::string& path, const Source& source, std::span<const Vec3d> positions,
                  const io::WriteOptions& options);

/// Takes from a scene what the command line leaves open, and settles all options that depend on the mesh. They refer to
/// the source. Returns the distances: one set for each output, then that of the inner skin if there is one.
std::vector<Distances> settle_options(Source& source, Arguments& args);
/// The same for layers: their heights above the wall, from there on. \throw ReadError, InvalidInput for a file of
/// heights, with its line.
std::vector<Distances> settle_layers(Source& source, Arguments& args);

}  // namespace vdb_offset::tool
