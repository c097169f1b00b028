// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ground/process/message_channel.h"
#include "ground/process/packing.h"
#include "messages/cad_mesh.h"

namespace vdb_offset::io {

// What the program and its worker, vdb_offset_cad, send each other. The worker first says its version; then each
// request has one reply.

/// What the worker is asked for.
enum class CadRequest : std::uint32_t {
  Mesh = 1,       ///< Reads the file and tessellates it: ReadCad; the reply is a CadMesh.
  Distances = 2,  ///< A list of CadPoint; the reply is a list of as many doubles.
  Write = 4,      ///< A WriteCad; the reply is a CadWritten.
  Offset = 3,     ///< A list of CadAim and one of CadPlace; the reply is a list of as many points as aims.
};

/// What the worker says.
enum class CadReply : std::uint32_t {
  Version = 1,                  ///< A text.
  Done = 2,                     ///< What the request's kind says.
  InvalidFile = 3,              ///< A text: `expected X, got Y`.
  OutOfMemory = 4,              ///< A text, as before.
  Failed = 5,                   ///< A text, as before: the request, and not the file, is at fault.
  Progress = kProgressMessage,  ///< A double: the share of the request that is done. Any number of them comes before
                                ///< another reply.
};

/// The file to be read, and how.
struct ReadCad {
  std::string path;    ///< Where the worker finds the file's bytes.
  std::string format;  ///< step, iges or brep
  CadMeshing meshing;
  std::uint64_t most_memory = 0;  ///< How many bytes more than it has at its start the worker may ask for; 0: any.
};

/// A point of an offset surface: of the point (u, v) of a face, at a distance, to either side.
struct CadPoint {
  double x = 0, y = 0, z = 0, u = 0, v = 0, distance = 0;
  std::uint64_t face = 0;  ///< An index of CadMesh::faces.
};

/// A point that is to be at distances from faces, and how many of the places that come with it are its own.
struct CadAim {
  double x = 0, y = 0, z = 0;  ///< Where to begin.
  double scale = 0;            ///< What is small is small compared to this.
  std::uint64_t places = 0;
};

/// Where on a face such a point comes from, and how far it is to be from that.
struct CadPlace {
  double u = 0, v = 0;
  double distance = 0;     ///< Negative is inward.
  std::uint64_t face = 0;  ///< An index of CadMesh::faces.
};

/// How far a face is offset, towards the outside of the material; negative is inward.
struct CadFaceDistance {
  double number = 0;
  std::string expression;  ///< Counts in place of the number, unless it is empty.
};

/// The model's offset as a file. Lengths are in the file's unit.
struct WriteCad {
  std::string format;                    ///< step or brep
  std::vector<CadFaceDistance> of_face;  ///< A number for all, or one for each face.
  double distance = 0;                   ///< That number, or the largest without its sign.
  bool is_even() const { return of_face.size() == 1 && of_face.front().expression.empty(); }
  double diagonal = 0;       ///< What percentages in expressions refer to.
  double blend = 0;          ///< Over how far distances change across smooth edges; 0: they do not.
  double fit_tolerance = 0;  ///< In the file's unit, > 0.
  bool thick = false;        ///< Write the solids between the source and its offset.
  bool held = false;         ///< Faces are held back where fronts meet, and not cut.
  double clearance = 0;      ///< How far they stay away from obstacles.
  std::vector<Vec3d> obstacle_positions;
  std::vector<std::array<std::uint32_t, 3>> obstacle_triangles;
  std::vector<Vec3d> positions;  ///< Of the offset mesh, for what exact faces fail at; empty: nothing is written then.
  double seconds = 0;            ///< Within which the reply is expected.
};

/// What a written file holds.
enum class CadMade : std::uint32_t {
  Nothing,   ///< No file.
  Solid,     ///< Solids: valid, closed and at the distance as far as 10,000 samples show.
  Shells,    ///< The same of a source that is no solid.
  Hybrid,    ///< Solids or shells, valid and as closed as the source, of exact faces and of triangles.
  Doubtful,  ///< The same, but some of it crosses itself or lies on the wrong side of the source; gaps say so.
};

struct CadWritten {
  std::string bytes;
  CadMade made = CadMade::Nothing;
  /// Faces of the source; faceted ones are triangles, at least in part, and missing ones are of bodies that could not
  /// be made.
  std::uint64_t kept = 0, fitted = 0, swallowed = 0, faceted = 0, missing = 0;
  std::uint64_t triangles = 0;           ///< Of the result.
  double exact_area = 0, flat_area = 0;  ///< Of exact faces and of triangles, by the offset mesh; 0: without these.
  std::uint64_t vanished = 0;            ///< Bodies of which nothing is left.
  std::uint64_t samples = 0;             ///< Points of the result that were measured.
  std::uint64_t held = 0;                ///< Faces of the source that are held back where fronts meet.
  double obstacle_gap = -1;       ///< The least distance from obstacles, in the file's unit; below 0: not measured.
  double least_held = 1;          ///< The least share of its distance that a point of them goes.
  double fit_error = 0;           ///< In the file's unit.
  double least = 0, most = 0;     ///< Distances of the result's points from the source, as shares; 0: not sampled.
  double volume = 0;              ///< Of solids; 0: not known.
  std::vector<std::string> gaps;  ///< What is not good, in words.
};

std::string pack(const ReadCad& read);
std::string pack(const WriteCad& write);
std::string pack(const CadWritten& written);
std::string pack(const CadMesh& mesh);

/// \throw BadMessage
ReadCad unpack_read(std::string_view bytes);
WriteCad unpack_write(std::string_view bytes);
CadWritten unpack_written(std::string_view bytes);
/// Every index, length and kind is checked. \throw BadMessage
CadMesh unpack_mesh(std::string_view bytes);

}  // namespace vdb_offset::io
