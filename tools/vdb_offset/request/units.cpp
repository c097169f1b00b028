// SPDX-License-Identifier: Apache-2.0
#include "request/units.h"

#include <fmt/format.h>

#include <cctype>
#include <string_view>

#include "request/option_values.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::tool {
namespace {

struct Unit {
  std::string_view name;
  double micrometres;  // whole, so that a quotient of two is the nearest number to what is meant
};
constexpr Unit kUnitsOfLength[] = {{"um", 1}, {"mm", 1000}, {"cm", 1e4}, {"m", 1e6}, {"in", 25400}, {"ft", 304800}};

}  // namespace

std::optional<double> micrometres_of(const std::string& unit) {
  for (const Unit& each : kUnitsOfLength)
    if (each.name == unit) return each.micrometres;
  return std::nullopt;
}

std::string unit_meant_by(std::string word) {
  for (char& letter : word) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (word == "inch" || word == "inches") return "in";
  return micrometres_of(word) ? word : "";
}

std::string name_of_unit(double micrometres) {
  for (const Unit& each : kUnitsOfLength)
    if (each.micrometres == micrometres) return std::string(each.name);
  return fmt::format("x {:.6g} mm", micrometres / *micrometres_of("mm"));
}

std::string Lengths::operator()(double length, int digits) const {
  return fmt::format("{:.{}g}{}{}", in_unit(length), digits, have_unit() ? " " : "", unit_);
}

std::string Lengths::value(double length_in_unit) const { return fmt::format("{:g}{}", length_in_unit, unit_); }

std::string Lengths::volume(double volume) const {
  return fmt::format("{:.6g}{}", volume * of_file_unit_ * of_file_unit_ * of_file_unit_,
                     have_unit() ? fmt::format(" {}³", unit_) : "");
}

std::string in_file_units(const std::string& option, const std::string& text, const std::string& file,
                          const std::function<std::optional<double>()>& file_unit, std::optional<Lengths>& found) {
  // The longest name counts: 0.2mm is no number of metres with an m behind it.
  const std::size_t letters = text.find_last_not_of("umcintf") + 1;
  const std::optional<double> given = micrometres_of(text.substr(letters));
  std::string number = text.substr(0, letters);
  while (number.ends_with(' ')) number.pop_back();
  const auto value = decimal<double>(number);
  if (!given || !value) return text;
  const std::optional<double> of_file = file_unit();
  require(of_file.has_value(),
          fmt::format("{}: '{}': {} does not state its unit; add --unit mm if its numbers are millimetres", option,
                      text, file.empty() || file == "-" ? "the file" : file));
  found = Lengths(text.substr(letters), *of_file / *given);
  return *given == *of_file ? number : fmt::format("{}", *value * *given / *of_file);
}

}  // namespace vdb_offset::tool
