// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "option_values.h"
#include "source.h"
#include "vdb_offset/distances.h"

/// Lengths as Python has them: numbers, arrays, and texts as the command takes them.
namespace vdb_offset::python {

/// A distance: a number, an array with one for each vertex, or a text: a number, a percentage of the diagonal, or an
/// expression. `what` is its name in messages. \throw InvalidOption, InvalidInput
Distances distances_of(const py::object& distance, const Source& source, const AskedOptions& asked,
                       const char* what = "distance");

/// Several distances. \throw as distances_of()
std::vector<Distances> distances_of_all(const py::list& distances, const Source& source, const AskedOptions& asked);

/// The distances of an inner skin, inward: negative. \throw as distances_of(), and InvalidInput where one leads
/// outward, or one of `outer` inward
Distances inward_distances_of(const py::object& inner, const Source& source, const AskedOptions& asked,
                              std::span<const Distances> outer);

/// A tolerance as a share of the distance and a length, one of which is 0: a number in world units, or a text with a
/// percentage. \throw InvalidOption
std::pair<double, double> tolerance_of(const py::object& tolerance);

/// A number of world units, or a text with one or percent. Nothing for anything else.
std::optional<GivenDistance> length_of(const py::object& given);

/// Distances by axis: a space in which they are one distance.
struct ByAxis {
  Metric metric;
  double distance = 0;
  std::string text;  ///< Both, in the words of reports.
};

/// What the keyword `distance_z` makes of the only one of some distances: that is the one in the plane across z. One of
/// both may be 0, which is a thousandth of the other. Nothing without the keyword. \throw InvalidOption
std::optional<ByAxis> by_axis(const py::dict& keywords, const py::list& distances, const Source& source,
                              const AskedOptions& asked);

}  // namespace vdb_offset::python
