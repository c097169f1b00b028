// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <gp_Pnt.hxx>
#include <gp_Vec.hxx>
#include <vector>

#include "judge/soup.h"

namespace vdb_offset::cad {

/// Faces that a point on its way must not meet.
struct Opposite {
  const Soup* soup;
  const std::vector<char>* faces;  ///< Null: all of the soup's.
  double speed = 0;                ///< How far their front goes while the point goes 1.
  double keep = 0;                 ///< How far the point stays away from it.
  double most_cosine = 1;          ///< Between the source's outsides at the point and at what it may meet.
};

/// How far a point goes, and what it meets there.
struct Room {
  double length;
  int triangle = -1;  ///< Of the opposite's soup; -1: nothing.
};

/// How far a point of the source goes along a unit vector, until it comes to where fronts meet: to a place that is no
/// farther from the opposite faces than these have gone meanwhile (Wang et al. 2005: where the distance from the source
/// no longer grows). By steps that are safe as distances are; so never farther than that.
/// \param outside the source's at the point \param most where it stops by itself
Room room_along(const gp_Pnt& from, const gp_Vec& way, const gp_Vec& outside, double most, const Opposite& opposite);

/// A place on a face of the source.
struct SourcePlace {
  gp_Pnt point;
  gp_Pnt2d uv;
  gp_Vec outside;
  int triangle;
};

/// Visits points all over a soup's triangle, the middles of parts whose sides are no longer than a length, but for
/// parts that are farther away than `far` from all that is opposite. Returns false if such parts were left out.
bool visit_triangle(const Soup& soup, int triangle, double apart, double far, const Opposite& opposite,
                    const std::function<void(const SourcePlace&)>& visit);

}  // namespace vdb_offset::cad
