// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "messages/cad_mesh.h"
#include "messages/cad_messages.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

/// A CAD file and OpenCASCADE, which reads it in a program of its own, vdb_offset_cad: whatever a broken file does to
/// it does not reach this process. The worker stays until the end, and answers more requests about the file that it has
/// read. One thread at a time.
///
/// All members throw, with `path` at the start of the message: InvalidInput if the file is at fault, be it that the
/// worker is ended by a signal or takes longer than it may; OutOfBudget if it asks for more memory than it may;
/// ReadError if there is no such worker, or it is of another version.
class CadWorker {
 public:
  /// Reads and tessellates the file's bytes, which are kept nowhere here. `format` is a name's ending, with or without
  /// a point: step, stp, iges, igs, brep. `seconds` is how long all requests together may take, this one included;
  /// `most_memory` how many bytes of addresses the worker may ask for, 0: any; `progress` is called with Stage::Read.
  CadWorker(std::string path, std::string_view bytes, std::string_view format, const CadMeshing& meshing,
            double seconds, std::uint64_t most_memory, const ProgressCallback& progress = {});
  ~CadWorker();
  CadWorker(CadWorker&&) noexcept;
  CadWorker& operator=(CadWorker&&) noexcept;

  const CadMesh& mesh() const { return mesh_; }
  CadMesh take_mesh() { return std::move(mesh_); }

  /// For each point how far its distance to the surface of its face is from the distance that it ought to have; of the
  /// surface, the point near (u, v) is the closest that counts. \throw InvalidInput for a face that is none
  std::vector<double> distance_errors(std::span<const CadPoint> points);

  /// Moves each aim to where it is at its distance from the faces of its places, of which each aim has as many as it
  /// says, in their order: see ExactSurface::bring_to_distances(). \throw InvalidInput for a face that is none
  std::vector<Vec3d> offset_points(std::span<const CadAim> aims, std::span<const CadPlace> places);

  /// Makes the model's offset, and the bytes of a file of it. `progress` is called with Stage::Write.
  CadWritten write(WriteCad write, const ProgressCallback& progress = {});

  /// Another request, and the payload of its reply. (The kinds that have a function are asked for by that.)
  std::string request(CadRequest kind, std::string_view payload, const ProgressCallback& progress = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
  CadMesh mesh_;
};

}  // namespace vdb_offset::io
