// SPDX-License-Identifier: Apache-2.0
// Makes a shell of sheets that meet at junctions. Two valid skins and the marks of junctions go in. Each wedge at a
// junction gets a vertex: the two of the skins come first, and further ones follow as splits. Wedges near junctions
// move to where wedge_positions.cpp wants them. A quad of the rim stands on each gap between sides; where quads that
// meet at a junction do not end on each other, the hole between them is triangulated. Corners of faces that fold or
// cross others then go back by a share in each round, to their skin or, at a junction, to the mesh. Those beside
// junctions are let out together once more, and return where that is faulty. If the rounds run out, faults are left.
// Crossings near those of the mesh are not mended.
#include "products/shell/junction_shell.h"

#include <algorithm>
#include <map>

#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"
#include "products/shell/shell_facts.h"
#include "products/shell/wedge_positions.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

// The share of its displacement that a corner of a faulty face keeps in each round. Larger shares take more rounds,
// each of which searches all crossings; smaller ones leave sheets thinner than they have to be. Not measured.
constexpr double kBack = 0.6;
// The share of its displacement below which a corner goes back to its start: eight rounds. Not measured.
constexpr double kLittle = 0.02;
// The most rounds: a corner needs no more than eight, but each may wake its neighbours. Not measured.
constexpr int kMostRounds = 60;

class JunctionShell {
 public:
  explicit JunctionShell(const JunctionInput& input)
      : input_(input), mesh_(input.sheets.mesh), sides_(find_sides(input.sheets)) {
    WedgePositions positions = find_wedge_positions(input_.sheets, sides_, input_.junctions);
    is_near_ = std::move(positions.is_near);
    place_vertices();
    find_displacements(positions);
  }

  Shell make() {
    assemble();
    if (input_.to_be_valid && make_valid()) let_out();
    count_junctions();
    return std::move(shell_);
  }

 private:
  void count_junctions() {
    shell_.kept = kept();
    shell_.is_junction.assign(input_.junctions.begin(), input_.junctions.end());
    for (std::size_t v = 0; v < shell_.kept.size(); ++v) {
      if (!input_.junctions[v]) continue;
      ++shell_.facts.junction_vertices;
      shell_.facts.short_junctions += shell_.kept[v] < 1;
    }
  }

  /// Of each vertex of the mesh the least share that its wedges keep; below 0 if none of them is near a junction.
  std::vector<double> kept() const {
    std::vector<double> least(mesh_.positions.size(), -1.0);
    for (std::uint32_t i = 0; i < sides_.wedge.size(); ++i) {
      const std::uint32_t w = sides_.wedge[i];
      if (!is_near_[w]) continue;
      double& own = least[mesh_.corners[i / 2]];
      own = own < 0 ? share_[w] : std::min(own, share_[w]);
    }
    return least;
  }

  // --- vertices

  /// Assigns a vertex of the shell to each side at each corner. Away from junctions it is that of the skin.
  void place_vertices() {
    const auto count = static_cast<std::uint32_t>(mesh_.positions.size());
    vertex_.resize(sides_.wedge.size());
    std::vector<std::uint32_t> taken(2 * mesh_.positions.size(), kNone);
    for (const std::uint8_t side : {0, 1}) {
      for (std::size_t f = 0; f < mesh_.face_count(); ++f)
        for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
          const std::uint32_t v = mesh_.corners[c], w = sides_.wedge[2 * c + side];
          const bool inner = input_.sheets.is_turned(f) != (side == 1);
          vertex_[2 * c + side] = input_.junctions[v] ? vertex_of(v, w, inner, taken) : v + (inner ? count : 0);
        }
    }
    wedge_.assign(2 * mesh_.positions.size() + splits_.size(), kNone);
    for (std::uint32_t i = 0; i < vertex_.size(); ++i) wedge_[vertex_[i]] = sides_.wedge[i];
  }

  std::uint32_t vertex_of(std::uint32_t v, std::uint32_t wedge, bool inner, std::vector<std::uint32_t>& taken) {
    const auto count = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [known, is_new] = numbers_.try_emplace({v, wedge}, kNone);
    if (!is_new) return known->second;
    const std::uint32_t first = v + (inner ? count : 0), second = v + (inner ? 0 : count);
    for (const std::uint32_t slot : {first, second}) {
      if (taken[slot] != kNone) continue;
      taken[slot] = wedge;
      return known->second = slot;
    }
    splits_.push_back({v, inner ? ShellPart::Inner : ShellPart::Outer});
    return known->second = 2 * count + static_cast<std::uint32_t>(splits_.size()) - 1;
  }

  // --- positions

  void find_displacements(const WedgePositions& positions) {
    start_.resize(sides_.wedges);
    displacement_.assign(sides_.wedges, Vec3d(0.0));
    share_.assign(sides_.wedges, 1.0);
    const std::size_t count = mesh_.positions.size();
    for (std::uint32_t i = 0; i < vertex_.size(); ++i) {
      const std::uint32_t v = mesh_.corners[i / 2], w = sides_.wedge[i], own = vertex_[i];
      start_[w] = input_.junctions[v] ? mesh_.positions[v] : own < count ? input_.outer[v] : input_.inner[v];
      if (is_near_[w]) displacement_[w] = (positions.position[w] - start_[w]) * positions.weight[w];
    }
  }

  Vec3d position_of(std::uint32_t wedge) const { return start_[wedge] + displacement_[wedge] * share_[wedge]; }

  void assemble() {
    shell_ = {};
    shell_.splits = splits_;
    Polygons& polygons = shell_.polygons;
    polygons.positions.assign(input_.outer.begin(), input_.outer.end());
    polygons.positions.insert(polygons.positions.end(), input_.inner.begin(), input_.inner.end());
    polygons.positions.resize(wedge_.size());
    for (std::uint32_t v = 0; v < wedge_.size(); ++v) {
      const std::uint32_t w = wedge_[v], of_mesh = shell_.source_vertex(v);
      if (w == kNone) {
        if (input_.junctions[of_mesh]) polygons.positions[v] = mesh_.positions[of_mesh];
      } else if (is_near_[w]) {
        polygons.positions[v] = position_of(w);
      }
    }
    for (const std::uint32_t side : {0u, 1u})
      for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        const std::uint32_t begin = mesh_.face_begin[f], size = mesh_.face_begin[f + 1] - begin;
        for (std::uint32_t k = 0; k < size; ++k)
          polygons.corners.push_back(vertex_[2 * (begin + (side == 0 ? k : (size - k) % size)) + side]);
        polygons.close_face();
      }
    add_rim();
    split_shell(mesh_, shell_);
  }

  // --- rim

  /// One end of a quad of the rim, at a vertex of the mesh: from one wedge to another.
  struct End {
    std::uint32_t from, to;  // vertices of the shell
    std::uint32_t face, corner;
  };

  std::uint32_t face_of(std::uint32_t corner) const {
    return static_cast<std::uint32_t>(std::upper_bound(mesh_.face_begin.begin(), mesh_.face_begin.end(), corner) -
                                      mesh_.face_begin.begin() - 1);
  }

  void add_rim() {
    std::map<std::uint32_t, std::vector<End>> ends;  // by the vertex that its own is welded to
    std::vector<RimFace> faces;
    for (const SheetSides::Gap& gap : sides_.gaps) {
      const std::uint32_t face = face_of(gap.corner[0]);
      const auto [from, to] = along(gap.corner[0], gap.side[0]);
      const auto [back_from, back_to] = along(gap.corner[1], gap.side[1]);  // which runs the other way
      faces.push_back({{to, from, back_to, back_from}, {face, gap.corner[0]}});
      // Split into the triangles that the offset was judged by (see rim_crossings.h).
      if (input_.sheets.is_turned(face))
        std::rotate(faces.back().corners.begin(), faces.back().corners.begin() + 1, faces.back().corners.end());
      note_end(ends, from, back_to, face, gap.corner[0]);
      note_end(ends, back_from, to, face, gap.corner[0]);
    }
    for (auto& [vertex, some] : ends) close(some, faces);
    std::stable_sort(faces.begin(), faces.end(), [](const RimFace& a, const RimFace& b) {
      return std::pair(a.origin.face, a.origin.corner) < std::pair(b.origin.face, b.origin.corner);
    });
    for (const RimFace& face : faces) append(face);
  }

  struct RimFace {
    std::vector<std::uint32_t> corners;
    Shell::RimOrigin origin;
  };

  /// The vertices where a side of a face starts and ends along an edge, in the direction that it has in the shell.
  std::array<std::uint32_t, 2> along(std::uint32_t corner, std::uint8_t side) const {
    const std::uint32_t f = face_of(corner),
                        next = corner + 1 < mesh_.face_begin[f + 1] ? corner + 1 : mesh_.face_begin[f];
    const std::uint32_t from = vertex_[2 * corner + side], to = vertex_[2 * next + side];
    return side == 0 ? std::array{from, to} : std::array{to, from};
  }

  void note_end(std::map<std::uint32_t, std::vector<End>>& ends, std::uint32_t from, std::uint32_t to,
                std::uint32_t face, std::uint32_t corner) const {
    const std::uint32_t v = shell_.source_vertex(from);
    if (!input_.junctions[v]) return;
    const bool at_start = mesh_.corners[corner] == v;
    const std::uint32_t next = corner + 1 < mesh_.face_begin[face + 1] ? corner + 1 : mesh_.face_begin[face];
    ends[input_.sheets.welded_to[v]].push_back({from, to, face, at_start ? corner : next});
  }

  /// Fills the holes that rims which meet at a vertex leave there, if they do not end on each other.
  void close(std::vector<End>& ends, std::vector<RimFace>& faces) const {
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = i + 1; j < ends.size(); ++j)
        if (wedge_[ends[i].from] == wedge_[ends[j].to] && wedge_[ends[i].to] == wedge_[ends[j].from]) {
          ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(j));
          ends.erase(ends.begin() + static_cast<std::ptrdiff_t>(i--));
          break;
        }
    while (!ends.empty()) {
      std::vector<std::uint32_t> hole = {ends.front().from};
      const Shell::RimOrigin origin{ends.front().face, ends.front().corner, true};
      std::uint32_t at = ends.front().to;
      ends.erase(ends.begin());
      while (wedge_[at] != wedge_[hole.front()]) {
        const auto next =
            std::find_if(ends.begin(), ends.end(), [&](const End& end) { return wedge_[end.from] == wedge_[at]; });
        if (next == ends.end()) break;
        hole.push_back(at);
        at = next->to;
        ends.erase(next);
      }
      std::reverse(hole.begin(), hole.end());
      split(hole, origin, faces);
    }
  }

  /// Splits a hole into triangles, which cover it once if it is flat.
  void split(std::vector<std::uint32_t> hole, const Shell::RimOrigin& origin, std::vector<RimFace>& faces) const {
    const std::vector<Vec3d>& at = shell_.polygons.positions;
    if (hole.size() < 3) return;
    if (hole.size() == 4) {
      const auto normal = [&](int a, int b, int c) {
        return (at[hole[b]] - at[hole[a]]).cross(at[hole[c]] - at[hole[a]]);
      };
      if (normal(0, 1, 2).dot(normal(0, 2, 3)) < 0) std::rotate(hole.begin(), hole.begin() + 1, hole.end());
    }
    std::vector<std::array<std::uint32_t, 3>> triangles;
    triangulate(at, hole, triangles);
    for (const auto& [a, b, c] : triangles) faces.push_back({{a, b, c}, origin});
  }

  /// Appends a face of the rim, without corners at equal positions; a face of fewer than three others is left out.
  void append(const RimFace& face) {
    const std::vector<Vec3d>& at = shell_.polygons.positions;
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t v : face.corners)
      if (corners.empty() || at[v] != at[corners.back()]) corners.push_back(v);
    while (corners.size() > 1 && at[corners.back()] == at[corners.front()]) corners.pop_back();
    if (corners.size() < 3) return;
    shell_.polygons.corners.insert(shell_.polygons.corners.end(), corners.begin(), corners.end());
    shell_.polygons.close_face();
    shell_.rim.push_back(face.origin);
    ++(corners.size() == 4 ? shell_.facts.rim_quads : shell_.facts.rim_triangles);
  }

  // --- validity

  /// The wedges at the corners of faces that fold or meet others, as far as they can go back.
  std::vector<std::uint32_t> find_faulty() {
    std::vector<std::uint8_t> faulty(shell_.polygons.face_count(), 0);
    const std::vector<Vec3d> written = written_positions(mesh_, shell_, input_.precision);
    mark_crossing(written, faulty);
    mark_inverted(written, faulty);
    std::vector<std::uint8_t> back(sides_.wedges, 0);
    for (std::size_t f = 0; f < faulty.size(); ++f)
      if (faulty[f])
        for (const auto v : shell_.polygons.view().face(f)) back[wedge_[v]] = 1;
    std::vector<std::uint32_t> wedges;
    for (std::uint32_t w = 0; w < back.size(); ++w)
      if (back[w] && can_go_back(w)) wedges.push_back(w);
    return wedges;
  }

  /// Takes corners back until no face is faulty. Returns true if that was reached, and any corner had to go back.
  bool make_valid() {
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<std::uint32_t> faulty = find_faulty();
      if (faulty.empty()) return round > 0;
      for (const auto w : faulty) {
        share_[w] *= kBack;
        if (share_[w] < kLittle) share_[w] = 0;
      }
      assemble();
    }
    return false;
  }

  /// Lets corners beside junctions out again, since they may have been in the way of junctions alone: all of them at
  /// once; then those that are still faulty go back to where they were, which was valid.
  void let_out() {
    const std::vector<double> held = share_;
    std::vector<std::uint8_t> is_held(share_.size(), 0);
    for (std::uint32_t i = 0; i < sides_.wedge.size(); ++i)
      is_held[sides_.wedge[i]] |= input_.junctions[mesh_.corners[i / 2]];
    for (std::size_t w = 0; w < share_.size(); ++w)
      if (!is_held[w]) share_[w] = 1;
    assemble();
    for (bool any = true; any;) {
      any = false;
      for (const auto w : find_faulty()) {
        any = any || share_[w] != held[w];
        share_[w] = held[w];
      }
      if (any) assemble();
    }
    if (find_faulty().empty()) return;
    share_ = held;
    assemble();
  }

  bool can_go_back(std::uint32_t wedge) const {
    return is_near_[wedge] && share_[wedge] > 0 && displacement_[wedge].lengthSqr() > 0;
  }

  /// Marks faces that meet others, away from where the mesh crosses itself.
  void mark_crossing(std::span<const Vec3d> written, std::vector<std::uint8_t>& faulty) {
    const Surface surface =
        build_surface({written, shell_.polygons.corners, shell_.polygons.face_begin, shell_.triangles}, {});
    const std::vector<TrianglePair> pairs = CrossingFinder(surface, surface.vertices).all();
    if (pairs.empty()) return;
    if (near_crossings_.empty()) near_crossings_ = find_near_crossings(mesh_, input_.weld);
    for (const TrianglePair& pair : pairs) {
      bool excused = false;
      for (const auto t : {pair.first, pair.second})
        for (const auto v : shell_.polygons.view().face(surface.face[t]))
          excused = excused || near_crossings_[shell_.source_vertex(v)];
      if (!excused) faulty[surface.face[pair.first]] = faulty[surface.face[pair.second]] = 1;
    }
  }

  /// Marks faces of the skins with a triangle that faces against its triangle in the mesh.
  void mark_inverted(std::span<const Vec3d> written, std::vector<std::uint8_t>& faulty) const {
    const PolygonView shell = shell_.view();
    for (std::size_t f = 0; f < 2 * shell_.skin_faces(); ++f) {
      const auto face = shell.face(f);
      if (std::none_of(face.begin(), face.end(), [&](auto v) { return can_go_back(wedge_[v]); })) continue;
      for (const auto& [a, b, c] : shell.triangles_of(f)) {
        const Vec3d now = (written[b] - written[a]).cross(written[c] - written[a]);
        const auto before = [&](std::uint32_t v) { return mesh_.positions[shell_.source_vertex(v)]; };
        if (now.dot((before(b) - before(a)).cross(before(c) - before(a))) < 0) faulty[f] = 1;
      }
    }
  }

  const JunctionInput& input_;
  PolygonView mesh_;
  SheetSides sides_;
  std::vector<std::uint8_t> is_near_;  // of each wedge
  std::vector<Vec3d> start_;           // of each wedge: its position if it goes back altogether
  std::vector<Vec3d> displacement_;    // of each wedge: from there to where it should be
  std::vector<double> share_;          // of each wedge: the share of its displacement that it keeps
  std::vector<std::uint32_t> vertex_;  // of the shell, for each side at each corner
  std::vector<std::uint32_t> wedge_;   // of each vertex of the shell; kNone for one without faces
  std::vector<Shell::Split> splits_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers_;  // by vertex of the mesh and wedge
  std::vector<std::uint8_t> near_crossings_;                                  // of each vertex of the mesh
  Shell shell_;
};

}  // namespace

Shell make_junction_shell(const JunctionInput& input) {
  VDB_OFFSET_ASSERT(input.outer.size() == input.sheets.mesh.positions.size());
  VDB_OFFSET_ASSERT(input.inner.size() == input.sheets.mesh.positions.size());
  VDB_OFFSET_ASSERT(input.junctions.size() == input.sheets.mesh.positions.size());
  return JunctionShell(input).make();
}

}  // namespace vdb_offset
