// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "arrays.h"
#include "option_values.h"
#include "source.h"

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

/// The metric in which distances along z are `distance_z`, and those in the plane across it `distance`, if the keyword
/// is given: both of one sign, as distances_of() has them. \throw InvalidOption
Metric metric_of(const py::dict& keywords, std::span<const Distances> distance, const Source& source,
                 const AskedOptions& asked);

}  // namespace vdb_offset::python
