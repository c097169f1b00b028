// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace vdb_offset::tool {

/// A unit of length by its name, in micrometres; none for another word. 'um', 'mm', 'cm', 'm', 'in' or 'ft'.
std::optional<double> micrometres_of(const std::string& unit);

/// A unit by its length, as it stands behind a number: its name, or if it has none its length, as in "x 2.5 mm".
std::string name_of_unit(double micrometres);

/// A text of an option without the unit behind its number, in units of the file: "0.2mm" is 0.2 where these are
/// millimetres, and 0.0002 where they are metres. Texts without a unit stay as they are. `file_unit` is asked for that
/// of the file, in micrometres, if there is a text with one. \throw UsageError for a unit where it is not known
std::string in_file_units(const std::string& option, const std::string& text,
                          const std::function<std::optional<double>()>& file_unit);

}  // namespace vdb_offset::tool
