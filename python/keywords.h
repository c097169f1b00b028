// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::python {

namespace py = pybind11;

/// Whether it is True or False, Python's own or NumPy's, which are numbers to Python.
inline bool is_truth(const py::object& given) {
  return py::isinstance<py::bool_>(given) || py::type::of(given).attr("__name__").cast<std::string>() == "bool_";
}

/// Reads keywords one by one, and leaves those alone that were not given. Each throws InvalidOption for a value that
/// means nothing.
class Keywords {
 public:
  explicit Keywords(const py::dict& given) : given_(given) {}

  py::object operator[](const char* name) const {
    return given_.contains(name) ? py::reinterpret_borrow<py::object>(given_[name]) : py::none();
  }

  template <class Value>
  void read(const char* name, Value& value) const {
    const py::object given = (*this)[name];
    if (given.is_none()) return;
    try {
      value = given.cast<Value>();
    } catch (const py::cast_error&) {
      throw InvalidOption(std::string(name) + ": expected " + what<Value>() + ", got " + text_of(given));
    }
  }
  template <class Value>
  void read(const char* name, std::optional<Value>& value) const {
    Value given{};
    if ((*this)[name].is_none()) return;
    read(name, given);
    value = given;
  }
  /// One of some words.
  template <class Value, std::size_t kCount>
  void read(const char* name, Value& value, const std::array<std::pair<const char*, Value>, kCount>& words) const {
    const py::object given = (*this)[name];
    if (given.is_none()) return;
    std::string expected;
    for (const auto& [word, meaning] : words) {
      if (py::isinstance<py::str>(given) && given.cast<std::string>() == word) {
        value = meaning;
        return;
      }
      expected += (expected.empty() ? "'" : " or '") + std::string(word) + "'";
    }
    throw InvalidOption(std::string(name) + ": expected " + expected + ", got " + text_of(given));
  }

  static std::string text_of(const py::object& given) { return py::repr(given).cast<std::string>(); }

 private:
  template <class Value>
  static const char* what() {
    if constexpr (std::is_same_v<Value, bool>) return "True or False";
    else if constexpr (std::is_integral_v<Value>) return "a whole number, 0 or more";
    else return "a number";
  }

  const py::dict& given_;
};

}  // namespace vdb_offset::python
