// SPDX-License-Identifier: Apache-2.0
#pragma once

// Objects of a scene file, and the shapes that they describe.

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "bytes/scanner.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset::scene {

using nlohmann::json;

/// An object of the scene. Every key must be asked for by the time finish() is called, so that a mistyped one is
/// reported and not ignored.
class JsonObject {
 public:
  JsonObject(const std::string& path, std::string where, const json& object)
      : path_(path), where_(std::move(where)), object_(object) {
    if (!object.is_object()) fail("an object");
  }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(const std::string& expected) const {
    throw InvalidInput(fmt::format("{}: expected {} at '{}'", path_, expected, where_));
  }
  const json* find(const char* key) {
    asked_.insert(key);
    const auto at = object_.find(key);
    return at == object_.end() ? nullptr : &*at;
  }
  JsonObject object(const char* key) {
    const json* value = find(key);
    return {path_, below(key), value ? *value : fail_missing(key, "an object")};
  }
  double number(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_number()) fail_missing(key, "a number");
    return value->get<double>();
  }
  double number(const char* key, double otherwise) { return find(key) ? number(key) : otherwise; }
  std::optional<double> optional_number(const char* key) {
    return find(key) ? std::optional(number(key)) : std::nullopt;
  }
  int count(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_number_integer()) fail_missing(key, "a whole number");
    const auto wide = value->get<std::int64_t>();
    if (wide < 0 || wide > 1000000000) fail_missing(key, "a whole number from 0 to 1e9");
    return static_cast<int>(wide);
  }
  std::string text(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_string()) fail_missing(key, "a text");
    return value->get<std::string>();
  }
  bool flag(const char* key, bool otherwise) {
    const json* value = find(key);
    if (!value) return otherwise;
    if (!value->is_boolean()) fail_missing(key, "true or false");
    return value->get<bool>();
  }
  Vec3d vector(const char* key) {
    const json* value = find(key);
    if (!value || !value->is_array() || value->size() != 3) fail_missing(key, "three numbers");
    Vec3d v;
    for (int k = 0; k < 3; ++k) {
      if (!(*value)[static_cast<std::size_t>(k)].is_number()) fail_missing(key, "three numbers");
      v[k] = (*value)[static_cast<std::size_t>(k)].get<double>();
    }
    return v;
  }
  void finish() const {
    for (const auto& [key, value] : object_.items())
      if (!asked_.contains(key))
        throw InvalidInput(fmt::format("{}: expected no key '{}'", path_, below(io::in_short(key))));
  }
  [[noreturn]] const json& fail_missing(const std::string& key, const std::string& expected) const {
    throw InvalidInput(fmt::format("{}: expected {} at '{}'", path_, expected, below(key)));
  }

 private:
  std::string below(const std::string& key) const { return where_.empty() ? key : where_ + "." + key; }

  const std::string& path_;
  std::string where_;
  const json& object_;
  std::set<std::string, std::less<>> asked_;
};

/// The mesh of a scene's "shape". \throw InvalidInput for what is none
Polygons make_shape(JsonObject shape);

}  // namespace vdb_offset::scene
