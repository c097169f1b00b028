// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "products/fill/front.h"

namespace vdb_offset {

/// A plane in which a front is open, and the edges there, with what is to be filled on their left seen from outside of
/// it. Openings in one plane are one.
struct OpenPlane {
  Vec3d origin;
  Vec3d normal;  ///< Unit length.
  std::vector<std::array<std::uint32_t, 2>> edges;
  bool meets_others = false;    ///< Its edges go on in other planes, and the normal leads out of what is to be filled.
  std::uint32_t patch = kNone;  ///< Of kind Periodic, that all of it is of.
};

/// Two axes across a normal of unit length, which make a right-handed frame with it; axes of coordinates if it is one.
std::array<Vec3d, 2> axes_across(const Vec3d& normal);

/// The planes that a front's open edges lie in. Edges that are connected lie in one, or in those of the patches of
/// sides that they belong to. \throw InvalidInput where they do not
std::vector<OpenPlane> open_planes(const VolumeMesh& volume, std::span<const std::array<std::uint32_t, 2>> edges);

/// The planes across no axis of which all edges are on one line, so that others could be meant.
std::vector<SymmetryPlane> guessed_planes(std::span<const Vec3d> points, std::span<const OpenPlane> planes);

/// Whether a front would enclose what is to be filled if its openings were closed: then it is inside, as in a pipe.
/// Else it is around the front, as around half a body.
bool is_enclosed_by(std::span<const Vec3d> points, std::span<const FrontTriangle> front,
                    std::span<const OpenPlane> openings);

/// Covers a plane's openings with triangles, which grow from the edges inwards, and adds these to the front. Points are
/// added to the mesh. Each piece is in the patch of the sides of layers around it, or else in one that is added.
/// \param name of patches that are added, and of all if they are `symmetric`
void cover(const OpenPlane& plane, const FillOptions& options, const std::string& name, bool is_symmetric,
           FillFront& front, VolumeMesh& volume);

/// For points at the edges of the first periodic patch's opening those of the second's that the mesh's motion takes
/// them to.
std::map<std::uint32_t, std::uint32_t> periodic_images(const VolumeMesh& volume, const OpenPlane& first,
                                                       const OpenPlane& second);

/// Covers the opening of the second periodic patch as the mesh's motion takes the first one's cover there.
/// \pre the first one is covered \throw FillFailed where their edges differ
void cover_as(const OpenPlane& first, const OpenPlane& second, FillFront& front, VolumeMesh& volume);

}  // namespace vdb_offset
