// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "option_values.h"
#include "source.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"

/// What calls return: dictionaries of arrays that own what they show.
namespace vdb_offset::python {

using Clock = std::chrono::steady_clock;

/// A result that is not valid, where nothing but a valid one is of use.
struct InvalidResult : Error {
  InvalidResult(const std::string& what, std::string statistics) : Error(what), report(std::move(statistics)) {}

  std::string report;  ///< JSON text.
};

/// JSON text as Python's objects.
py::object from_json(const std::string& text);

py::array states_of(const std::vector<VertexState>& states);
py::array distances_array(const Distances& distances, std::size_t count);

/// How far each face is off as an array, all NaN where nothing is asked of any; None unless that was asked for.
py::object face_errors_of(std::vector<float> errors, const Source& source, const AskedOptions& asked);

/// What is reported of every offset.
py::dict as_dict(OffsetResult result, const RunFacts& run, const Source& source, const AskedOptions& asked);

RunFacts facts_of_run(const std::string& distance, Clock::time_point start);
/// A distance in the words of reports.
std::string text_of(const py::object& distance);

/// \throw InvalidOption if the field is to be saved, but nothing moves, so that there is none
void require_field(const AskedOptions& asked, std::span<const Distances> distances);
/// Saves the field of the first one of several results, if that was asked for. Needs no lock of Python's.
/// \throw WriteError
void save_field(const AskedOptions& asked, const OffsetResult& result, const std::string& distance);

}  // namespace vdb_offset::python
