// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

/// DXF files for tests, and a reader of them that has nothing to do with the one that is tested.
namespace dxf_text {

/// Groups from a short form: "0|LINE 8|cut 10|1.5". A tilde stands for a blank.
inline std::string groups(const std::string& brief) {
  std::istringstream words(brief);
  std::string text;
  for (std::string word; words >> word;) {
    const std::size_t bar = word.find('|');
    std::string value = word.substr(bar + 1);
    for (char& c : value)
      if (c == '~') c = ' ';
    text += word.substr(0, bar) + '\n' + value + '\n';
  }
  return text;
}

/// A file with entities, and with groups of the sections before them, in the short form.
inline std::string file(const std::string& entities, const std::string& header = "", const std::string& blocks = "",
                        const std::string& tables = "") {
  const auto section = [](const std::string& name, const std::string& inside) {
    return inside.empty() ? "" : "0|SECTION 2|" + name + " " + inside + " 0|ENDSEC ";
  };
  return groups(section("HEADER", header) + section("TABLES", tables) + section("BLOCKS", blocks) +
                "0|SECTION 2|ENTITIES " + entities + " 0|ENDSEC 0|EOF");
}

struct Entity {
  std::string type;
  std::vector<std::pair<int, std::string>> groups;

  std::string value(int code) const {
    for (const auto& [its, value] : groups)
      if (its == code) return value;
    return "";
  }
  double number(int code) const { return std::atof(value(code).c_str()); }
  std::vector<double> numbers(int code) const {
    std::vector<double> all;
    for (const auto& [its, value] : groups)
      if (its == code) all.push_back(std::atof(value.c_str()));
    return all;
  }
};

/// The entities of the section ENTITIES, vertices and all, each on its own.
inline std::vector<Entity> entities(const std::string& text) {
  std::vector<Entity> found;
  std::istringstream lines(text);
  std::string section;
  bool is_name = false;
  for (std::string code, value; std::getline(lines, code) && std::getline(lines, value);) {
    if (!value.empty() && value.back() == '\r') value.pop_back();
    const int number = std::atoi(code.c_str());
    if (is_name) section = value;
    is_name = number == 0 && value == "SECTION";
    if (section != "ENTITIES" || is_name) continue;
    if (number == 0 && value == "ENDSEC") section.clear();
    else if (number == 0) found.push_back({value, {}});
    else if (!found.empty()) found.back().groups.emplace_back(number, value);
  }
  return found;
}

}  // namespace dxf_text
