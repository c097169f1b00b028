// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "hold/held_field.h"
#include "hold/room.h"
#include "judge/soup.h"
#include "offset/offset_surface.h"

namespace vdb_offset::cad {

struct HoldRequest {
  TopoDS_Shape source;                  ///< All bodies.
  std::vector<FaceDistance> distances;  ///< Of each face as TopExp_Explorer meets them, towards the outside.
  double largest = 0;                   ///< Of them, without its sign.
  const Soup* obstacles = nullptr;      ///< Null: there are none.
  double clearance = 0;                 ///< From obstacles.
};

/// Holds the faces of an offset back where they would meet others: each to where the fronts meet, less a margin, and
/// with what is joined to it smoothly. Faces that share an edge or a vertex do not hold each other: their offsets are
/// cut.
class HoldBack {
 public:
  explicit HoldBack(HoldRequest request);

  /// Lets these faces hold each other, if they share no vertex; false if none of them is new.
  bool add(const std::vector<std::array<int, 2>>& pairs);
  /// How far each face goes, towards the outside.
  std::vector<FaceDistance> distances();
  std::size_t held() const { return held_; }     ///< Faces that are held back, as of then.
  double least_share() const { return least_; }  ///< The least share of its distance that a point of them goes.

 private:
  struct HeldFace;  // what has been told of one
  /// Faces that are opposite to one, by their speed and by how far to stay away from them.
  using Masks = std::map<std::array<double, 2>, std::vector<char>>;
  void find_neighbours();
  void find_miters();
  void find_facing();
  std::vector<Opposite> opposites_of(std::size_t face, Masks& masks) const;
  void constrain(std::size_t face, HeldField& field, HeldFace& held);
  double share_at(std::size_t face, const SourcePlace& at, Opposite opposite) const;
  void constrain_beyond(const SourcePlace& at, double share, double most, HeldField& field) const;
  bool is_reached(std::size_t face, const std::vector<HeldFace>& all) const;
  FaceDistance held_distance(std::size_t face, const std::shared_ptr<const HeldField>& field,
                             const HeldFace& held) const;

  HoldRequest request_;
  Soup soup_;
  double spacing_;  // of fields
  std::vector<std::uint32_t> piece_;
  std::vector<double> most_, sign_;  // of each face: how far it goes at most, and there outward (1) or inward (-1)
  std::vector<std::vector<int>> triangles_;  // of each face
  std::set<std::array<int, 2>> neighbours_, pairs_;
  std::map<std::array<int, 2>, std::array<int, 2>> sides_;  // of faces, by their nodes: the triangles there, or -1
  std::optional<Soup> miters_;
  std::set<std::array<int, 2>> joints_;  // sides of triangles across which a face is joined smoothly, by their nodes
  std::size_t held_ = 0;
  double least_ = 1;
};

}  // namespace vdb_offset::cad
