// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "file_plan.h"
#include "request/request.h"
#include "source.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/options.h"
#include "vdb_offset/scene.h"

namespace vdb_offset::tool {

/// Exit codes of the command.
enum ExitCode { kDone = 0, kUsage = 1, kInput = 2, kProcessing = 3, kOutput = 4 };

/// What a request asks of a source: everything that a run needs, lengths in world units. Refers to the request and the
/// source.
struct Job {
  const Request& request;
  const Source& source;
  OffsetOptions options;  ///< All but the distance and the progress.
  /// The meshes that are written, but for their names; none where OUTPUT is no mesh file.
  std::optional<io::Target> target{};
  bool shell = false;                  ///< By the command line or a scene.
  std::vector<DistanceRequest> asked;  ///< The distances as given, one for each output; of layers: none.
  std::vector<Distances> distances;    ///< One set for each output, then that of the inner skin if there is one; of
                                       ///< layers: their heights above the wall, from there on.
  std::optional<PolygonView> to_fit;   ///< The mesh that the source is to make room for, in place of a distance.
  std::vector<std::string> files_of_heights;  ///< Those that a file of heights names.
  scene::Expectations expect;                 ///< What a scene expects of its own distance.
  FilePlan files;                             ///< All that is read and written.

  bool curves() const { return source.curves.has_value(); }
  /// What becomes of sharp corners, also where it was not asked for: of layers what the library does with them.
  Corners corners() const { return options.corners.value_or(request.layers ? Corners::Round : Corners::Miter); }
};

/// Settles all that depends on the mesh: takes from a scene what the command line leaves open, selects faces, evaluates
/// distances. `job.files`, the target and the precision are left to resolve(). \throw ReadError, InvalidInput,
/// InvalidOption
Job resolve_options(const Request& request, const Source& source);

/// What the file of a source whose faces are split keeps of coordinates: no more than the source, nor than the file
/// that it is written to.
Precision precision_of_refined(const Job& job);

/// Makes a job of a request, all of it. \throw ReadError, InvalidInput, InvalidOption; for a file of heights with its
/// line
Job resolve(const Request& request, const Source& source);

}  // namespace vdb_offset::tool
