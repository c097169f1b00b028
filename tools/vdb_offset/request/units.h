// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace vdb_offset::tool {

/// A unit of length by its name, in micrometres; none for another word. 'um', 'mm', 'cm', 'm', 'in' or 'ft'.
std::optional<double> micrometres_of(const std::string& unit);

/// The unit that a word means: its name in other letters, or "inch"; empty for another word.
std::string unit_meant_by(std::string word);

/// A unit by its length, as it stands behind a number: its name, or if it has none its length, as in "x 2.5 mm".
std::string name_of_unit(double micrometres);

/// Lengths in words: in the unit that the distance was given with, which is then named, or as the file has them.
class Lengths {
 public:
  Lengths() = default;
  /// \param unit its name \param of_file_unit how many of it are one of the file's
  Lengths(std::string unit, double of_file_unit) : unit_(std::move(unit)), of_file_unit_(of_file_unit) {}

  bool have_unit() const { return !unit_.empty(); }
  double in_unit(double length) const { return length * of_file_unit_; }
  /// So many digits and the unit, as in "0.2 mm".
  std::string operator()(double length, int digits = 6) const;
  /// As the value of an option, as in "0.2mm"; of a length that is in this unit already.
  std::string value(double length_in_unit) const;
  std::string volume(double volume) const;

 private:
  std::string unit_;
  double of_file_unit_ = 1;
};

/// A text of an option without the unit behind its number, in units of the file: "0.2mm" is 0.2 where these are
/// millimetres, and 0.0002 where they are metres. Texts without a unit stay as they are. `file_unit` is asked for that
/// of the file, in micrometres, if there is a text with one. \throw UsageError for a unit where it is not known
/// \param file its name, for that
/// \param found gets the unit, if there is one
std::string in_file_units(const std::string& option, const std::string& text, const std::string& file,
                          const std::function<std::optional<double>()>& file_unit, std::optional<Lengths>& found);

}  // namespace vdb_offset::tool
