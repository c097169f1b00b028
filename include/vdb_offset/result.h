// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/options.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// What became of a vertex.
enum class VertexState : std::uint8_t {
  Reached,       ///< Its exact distance is the target's, to 1e-6 of it and the rounding of the coordinates.
  Collision,     ///< Stopped short where the distance grows no further: at the medial axis, or closed in.
  Limited,       ///< Held back to keep the result valid.
  OutsideField,  ///< Left the voxels that the field covers before it arrived.
  Unused,        ///< In no face; it stays where it is.
  Mitered,       ///< Where the planes around it meet, moved by the distance: itself farther off. See Corners::Miter.
  Cut,  ///< On the way there, as far as the miter limit allows: farther off than the distance, its faces short.
};

inline constexpr std::size_t kVertexStateCount = 7;

/// Whether a vertex in use falls short of what was asked of it.
constexpr bool falls_short(VertexState state) {
  return state == VertexState::Collision || state == VertexState::Limited || state == VertexState::OutsideField;
}

VDB_OFFSET_API const char* name(VertexState state);

/// A vertex has reached its distance if it is off by no more than this share of the distance. Rounding of coordinates
/// to seven digits is allowed for apart. Not measured: small beside what a mesh is off between its vertices.
inline constexpr double kReachedTolerance = 1e-6;

/// Faults of a result, counted.
struct FaultCounts {
  std::size_t inverted = 0, collapsed = 0;  ///< Faces.
  std::size_t crowded = 0;                  ///< Faces nearer to an obstacle than may be, or through the source.
  std::size_t crossings = 0;                ///< Pairs of triangles that meet, and did not in the source.

  std::size_t total() const { return inverted + collapsed + crowded + crossings; }
};

/// What is wrong with a face. Of several faults the first of these counts; crossings are those of its triangles.
enum class FaceFault : std::uint8_t { None, Inverted, Collapsed, Crowded, Crossing };
inline constexpr std::size_t kFaceFaultCount = 5;

VDB_OFFSET_API const char* name(FaceFault fault);

/// What limit() found and did.
struct LimitStatistics {
  FaultCounts before;                     ///< In what propagate() made; of curves, with points in order.
  FaultCounts left;                       ///< 0 but where rounding to the format's numbers makes a source cross itself.
  std::size_t source_crossings = 0;       ///< Pairs of triangles that meet in the source: counted, not repaired.
  bool more_source_crossings = false;     ///< There are more of them than these, and what is near is not looked at.
  std::size_t crossings_near_source = 0;  ///< New pairs within two rings of one of those, which has to slide.
  std::size_t followed_vertices = 0;      ///< Vertices with a warm start from a farther offset.
  std::size_t untanglings = 0;            ///< Rounds in which patches were untangled.
  std::size_t rounds = 0;                 ///< Rounds in which vertices were pulled back or let out again.
  std::size_t limited_vertices = 0;
  std::size_t faded_vertices = 0;  ///< Those of them that would be farther, did not what is beside them fall short.
  double thickness_lost = 0;       ///< Mean over the vertices of (asked - achieved) / asked that limit() took away.
};

/// What became of borders, and of what stays in planes.
struct BorderFacts {
  /// A plane that a border lies in, and does not stay in: its faces rise from that plane by too little.
  struct LeftPlane {
    SymmetryPlane plane;  ///< World coordinates.
    double farthest;      ///< How far from it a vertex of the border ends at most, world units.
  };
  std::vector<SymmetryPlane> planes;  ///< World coordinates.
  std::size_t named_planes = 0;       ///< How many of them, the first ones, were named by the user.
  std::vector<LeftPlane> left;
  std::size_t held_vertices = 0;     ///< Of the surface, that stay in them.
  std::size_t beyond = 0;            ///< Vertices of the surface that end beyond a plane which it lies on one side of.
  std::size_t across_vertices = 0;   ///< Other vertices at borders, which go in the plane across these if they can.
  std::size_t strayed_vertices = 0;  ///< Those of them that leave it by more than a degree,
  double worst_angle = 0;            ///< and the worst of all, in degrees.
};

/// How far faces are off their distance, at points evenly spread over their area in the offset: the difference to the
/// distance asked for there, relative to that. The vertices alone are put at the distance: beside a sharp corner, or
/// between the vertices of a coarse mesh, flat faces are nearer. Of curves: along segments, by length.
struct FaceError {
  std::size_t samples = 0;  ///< Points that were measured: 40,000, or fewer on a mesh of few triangles.
  double mean = 0, quantile_99 = 0, worst = 0;
  double at_distance = 0;  ///< Share of the area that is off by 1 % or less.
  /// Share of the area that is too far away by more than 1 % beside sharp corners where more planes meet than one point
  /// can be on, and the most by which any of it is. 0 where less than 1 % of the area is too far away.
  double beyond = 0, most_beyond = 0;
  /// By how much more than `mean` points are too far away on average: beside miters, where it is the planes of their
  /// faces that are at the distance.
  double farther = 0;
  /// Shares of the mean, all 0 if that is 1 % or less, or not known. Of faces with a vertex that falls short, whatever
  /// the distance where none of these moves at all (`stuck`). Of others: what a face that looks the other way takes, as
  /// in walls and gaps that are narrower than two distances; the rest, if the face has a vertex at a sharp corner, or
  /// on an edge of more than two faces, that is not in the face's own plane at the distance; and the rest of all
  /// others.
  double held_back = 0, stuck = 0, no_room = 0, corners = 0, coarse = 0;
};

/// What became of the vertices on creases that move, with Corners::Miter. Vertices that are welded count once.
struct MiterFacts {
  std::size_t on_creases = 0;
  std::size_t mitered = 0, cut = 0;  ///< Vertices in these states.
  std::size_t unproven = 0;  ///< No point is on all planes or little beyond, or something else is nearer to it, or
                             ///< an obstacle is in the way.
  std::size_t taken_back =
      0;              ///< Proven, and elsewhere in the end: their faces would have been faulty, or had no room.
  double excess = 0;  ///< Of mitered vertices, the most by which a plane goes farther than the distance, as a share of
                      ///< it: where more planes meet than one point can be on.
};

/// How exactly vertices are at their distances from the faces of a CAD model, of those that are said to be there.
struct ExactFacts {
  std::size_t vertices = 0;
  double mean = 0, worst = 0;  ///< World units.
};

/// What of a CAD model's faces became faces of a file.
struct CadFileFacts {
  enum class Made {
    Solid,     ///< Solids: valid, closed and at the distance as far as samples show.
    Shells,    ///< The same of a source that is no solid.
    Hybrid,    ///< Valid solids or shells, as closed as the source, of exact faces and of triangles of the offset mesh.
    Doubtful,  ///< The same, but some of it crosses itself or lies on the wrong side of the source; gaps say so.
  };
  Made made = Made::Hybrid;
  /// Faces of the source: that stay what they are (plane, cylinder, cone, sphere, torus), that are fitted, that the
  /// distance swallows, that are triangles, at least in part, and that are of bodies which could not be made.
  std::size_t kept = 0, fitted = 0, swallowed = 0, faceted = 0, missing = 0;
  std::size_t triangles = 0;  ///< Faces of the result that are triangles of the offset mesh.
  double exact_share = 1;     ///< Of the area of bodies that have such, by the offset mesh: what is of exact faces.
  std::size_t vanished = 0;   ///< Solids of which nothing is left.
  std::size_t held = 0;       ///< Faces of the source that are held back, as fronts meet or obstacles are near.
  double least_held = 1;      ///< The least share of its distance that a point of these goes.
  /// How near it is to obstacles, to 1 % of the distance, world units; none: there are none, or it is not whole.
  std::optional<double> obstacle_gap;
  double fit_error = 0;           ///< Of fitted faces, the most, world units.
  std::size_t samples = 0;        ///< Points of it that were measured; 0: none.
  double least = 0, most = 0;     ///< Their distances from the source, as shares, to 1 %; 0: not measured.
  double volume = 0;              ///< Of solids; 0: not known.
  std::vector<std::string> gaps;  ///< What is not as it should be, in words.
};

/// What is proven of the faces of an offset, at every point of them. Shares are of the area that the faces which move
/// have in the source.
struct CertifiedFaces {
  double share = 0, length = 0;  ///< The tolerance: of the distance, or in world units.
  double certified = 0;          ///< Share of the area every point of which is proven to be within the tolerance.
  double there = 0;              ///< Share of the area of faces whose vertices all get to their distance.
  /// The largest error beyond the tolerance that was found on faces whose vertices all get there, and on any that move,
  /// relative to the distance: at points spread over those that are not certified. 0 if there is none.
  double worst_left = 0, worst = 0;
  std::size_t source_faces = 0, source_vertices = 0;  ///< Of the mesh before faces were split; 0 if none were to be.
  /// Pairs of triangles that meet in that mesh; LimitStatistics has those of its pieces.
  std::size_t source_crossings = 0;
  bool out_of_faces = false;  ///< More faces would have been needed than may be made.
};

/// How much of an open surface, of open curves, or of the wall of layers has room for a distance on either side: the
/// file alone decides which side the faces point to, and is often wrong.
struct VDB_OFFSET_API SideRoom {
  bool known = false;          ///< It is looked for where little has reached its distance.
  double here = 1, there = 1;  ///< Shares of the vertices: on the side that was asked for, and on the other one.

  /// Whether the other side may well be the one that was meant.
  bool suggests_other() const;
};

/// Gaps between a result and its obstacles. World units; triangles of the whole mesh, whether or not they move.
struct ObstacleFacts {
  double gap = 0, starting_gap = 0;  ///< Least distance to an obstacle: of the result as written, and of the input.
  std::size_t near = 0;              ///< Triangles of the result nearer than the clearance, or that meet an obstacle.
  std::size_t touching = 0;          ///< Pairs of the input's triangles and obstacles' that meet: not through each
  std::size_t crossing = 0;          ///< other, and through.
};

/// What fit() did. Gaps are world units, below 0 inside of the other mesh, if that is a solid.
struct FitFacts {
  double clearance = 0;
  double gap = 0, starting_gap = 0;         ///< Least gap: of the result as written, and of the input.
  std::size_t near = 0, near_at_start = 0;  ///< Triangles nearer than the clearance by more than 1e-6 of it.
  std::size_t moved = 0;                    ///< Vertices of the mesh that gave way.
  double deepest = 0;                       ///< How far any went inward, as exact distance from the input.
  std::size_t rounds = 0;                   ///< Offsets that were made.
  bool is_signed = false;                   ///< The other mesh is a solid: what is inside of it is known.
  std::size_t enclosed = 0;                 ///< Components of the other mesh that lie inside of the result as a whole.
};

/// Figures of a run, beside its result.
struct OffsetStatistics {
  MeshFacts facts;
  GridPlan plan;
  int threads = 0;
  std::size_t active_voxels = 0, leaf_nodes = 0;
  std::size_t phi_bytes = 0, closest_bytes = 0, gradient_bytes = 0;
  std::array<double, kStageCount> seconds{};  ///< By Stage.
  std::array<std::size_t, kVertexStateCount> vertices_by_state{};
  std::size_t straight_vertices = 0;
  double rounding = 0;  ///< Of meshes: most that a coordinate changes by when it is written, world units.
  std::size_t disagreeing_distances = 0;  ///< Vertices welded with one that was given another distance; of
                                          ///< layers, at the height with the most.
  LimitStatistics limit;
  BorderFacts borders;
  MiterFacts miters;
  std::optional<ExactFacts> exact;  ///< With OffsetOptions::exact; not of layers.
  SideRoom room;
  std::optional<ObstacleFacts> obstacles;   ///< If there are any. Of layers: of the outermost surface.
  std::optional<FitFacts> fit;              ///< Of what fit() made.
  FaceError faces;                          ///< Of layers: of the outermost surface.
  std::optional<CertifiedFaces> certified;  ///< If a tolerance was asked for.
};

struct DistanceField;

struct OffsetResult {
  std::vector<Vec3d> positions;     ///< One per input vertex, in the input's order.
  std::vector<VertexState> states;  ///< One per input vertex.
  std::vector<double> achieved;     ///< Exact unsigned distance to the input surface, world units.
  Distances distances;              ///< What was asked of each input vertex, in the end.
  /// Faces disagree about the outside, and some of their triangles count as turned round (see orientation.h).
  bool has_turned_faces = false;
  OffsetStatistics statistics;
  std::shared_ptr<DistanceField> field;  ///< Only with keep_field and a distance other than 0.
  /// Only with keep_paths: the positions of each input vertex on its march, from that in the source to the last; and
  /// behind these its final position, if it has been moved to keep the result valid.
  std::vector<std::vector<Vec3d>> paths;
  /// Only with keep_face_errors and a distance other than 0: of each input face the mean error of points of it, as a
  /// share of the distance asked there. NaN for faces that nothing is asked of, or that have no area.
  std::vector<float> face_errors;
  /// Only with keep_face_errors and Collision::Limit: the faults that are left, one for each input face. Empty if there
  /// are none.
  std::vector<FaceFault> face_faults;
};

}  // namespace vdb_offset
