// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

/// What two faces have in common: whether they go along it in opposite directions, as neighbours do.
struct Neighbour {
  std::uint32_t face;
  bool agrees;
};

struct Side {
  std::uint32_t face;
  bool is_forward;
};

struct Neighbours {
  std::vector<std::vector<Neighbour>> of;
  std::vector<std::uint8_t> is_open;  ///< Faces with an edge that has no other face.
};

Neighbours find_neighbours(const BodyMesh& mesh) {
  std::unordered_map<std::uint64_t, std::vector<Side>> sides;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
    for (const Triangle& t : mesh.faces[f].triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.faces[f].nodes[t[k]].vertex, b = mesh.faces[f].nodes[t[(k + 1) % 3]].vertex;
        if (mesh.is_on_edge[a] && mesh.is_on_edge[b]) sides[BodyMesh::key(a, b)].push_back({f, a < b});
      }
  Neighbours neighbours{std::vector<std::vector<Neighbour>>(mesh.faces.size()),
                        std::vector<std::uint8_t>(mesh.faces.size(), 0)};
  for (const auto& [key, at] : sides) {
    if (at.size() == 1) neighbours.is_open[at[0].face] = 1;
    if (at.size() != 2 || at[0].face == at[1].face) continue;
    const bool agrees = at[0].is_forward != at[1].is_forward;
    neighbours.of[at[0].face].push_back({at[1].face, agrees});
    neighbours.of[at[1].face].push_back({at[0].face, agrees});
  }
  return neighbours;
}

double volume_of(const BodyMesh& mesh, const FaceMesh& face, const gp_Pnt& from) {
  double six = 0;
  for (const Triangle& t : face.triangles) {
    const gp_Vec a(from, mesh.positions[face.nodes[t[0]].vertex]), b(from, mesh.positions[face.nodes[t[1]].vertex]),
        c(from, mesh.positions[face.nodes[t[2]].vertex]);
    six += a.DotCross(b, c);
  }
  return six / 6;
}

void turn(FaceMesh& face) {
  for (Triangle& t : face.triangles) std::swap(t[1], t[2]);
  face.side = -face.side;
}

/// Faces that hang together, and which of them have to be turned to be as the first is.
struct Part {
  std::vector<std::uint32_t> faces;
  std::vector<std::uint8_t> is_turned;
  bool is_closed = true;
};

Part part_of(std::uint32_t first, const Neighbours& neighbours, std::vector<std::uint8_t>& is_seen) {
  Part part;
  part.faces.push_back(first);
  part.is_turned.push_back(0);
  is_seen[first] = 1;
  for (std::size_t k = 0; k < part.faces.size(); ++k) {
    part.is_closed = part.is_closed && !neighbours.is_open[part.faces[k]];
    for (const Neighbour& next : neighbours.of[part.faces[k]]) {
      if (is_seen[next.face]) continue;
      is_seen[next.face] = 1;
      part.faces.push_back(next.face);
      part.is_turned.push_back(static_cast<std::uint8_t>(next.agrees ? part.is_turned[k] : !part.is_turned[k]));
    }
  }
  return part;
}

/// Turns the lesser part of the faces.
void turn_lesser(BodyMesh& mesh, const Part& part) {
  const auto count = static_cast<std::size_t>(std::count(part.is_turned.begin(), part.is_turned.end(), 1));
  const bool is_other = 2 * count > part.faces.size();
  for (std::size_t k = 0; k < part.faces.size(); ++k)
    if ((part.is_turned[k] != 0) != is_other) turn(mesh.faces[part.faces[k]]);
}

/// Turns what has to be turned.
void turn_outward(BodyMesh& mesh, bool is_solid) {
  const Neighbours neighbours = find_neighbours(mesh);
  std::vector<std::uint8_t> is_seen(mesh.faces.size(), 0);
  double whole = 0;
  bool is_closed = true;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (is_seen[f]) continue;
    const Part part = part_of(f, neighbours, is_seen);
    turn_lesser(mesh, part);
    double volume = 0;
    for (const std::uint32_t face : part.faces) volume += volume_of(mesh, mesh.faces[face], mesh.positions[0]);
    whole += volume;
    is_closed = is_closed && part.is_closed;
    // A solid's inner shells look into their hollows; shells of no solid outward, each.
    if (!is_solid && part.is_closed && volume < 0)
      for (const std::uint32_t face : part.faces) turn(mesh.faces[face]);
  }
  if (is_solid && is_closed && whole < 0)
    for (FaceMesh& face : mesh.faces) turn(face);
}

}  // namespace

std::size_t orient(BodyMesh& mesh, bool is_solid) {
  if (mesh.positions.empty()) return 0;
  std::vector<double> before;
  for (const FaceMesh& face : mesh.faces) before.push_back(face.side);
  turn_outward(mesh, is_solid);
  std::size_t turned = 0;
  for (std::size_t f = 0; f < before.size(); ++f) turned += mesh.faces[f].side != before[f];
  return turned;
}

}  // namespace vdb_offset::cad
