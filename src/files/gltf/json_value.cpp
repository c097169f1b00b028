// SPDX-License-Identifier: Apache-2.0
#include "gltf/json.h"

#include <fmt/format.h>

#include <cmath>

#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

// Characters of a value that a message shows.
constexpr std::size_t kMostShown = 40;

std::string shown(const nlohmann::json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return fmt::format("an array of {}", value.size());
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (text.size() > kMostShown) text = text.substr(0, kMostShown) + "...";
  return text;
}

}  // namespace

void JsonValue::fail(const std::string& expected, const std::string& found) const {
  throw InvalidInput(
      fmt::format("{}: {}: expected {}, got {}", *file_, where_.empty() ? "the JSON text" : where_, expected, found));
}

void JsonValue::fail(const std::string& expected) const { fail(expected, shown(*value_)); }

std::optional<JsonValue> JsonValue::find(const char* key) const {
  if (!value_->is_object()) fail("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return JsonValue(*this, *found, where_.empty() ? key : where_ + "." + key);
}

JsonValue JsonValue::at(const char* key) const {
  std::optional<JsonValue> found = find(key);
  if (!found) fail(fmt::format("\"{}\"", key), "none");
  return *found;
}

std::size_t JsonValue::size() const {
  if (!value_->is_array()) fail("an array");
  return value_->size();
}

JsonValue JsonValue::operator[](std::size_t i) const {
  if (i >= size()) fail(fmt::format("at least {} elements", i + 1));
  return {*this, (*value_)[i], fmt::format("{}[{}]", where_, i)};
}

void JsonValue::for_each(const std::function<void(const std::string&, const JsonValue&)>& visit) const {
  if (!value_->is_object()) fail("an object");
  for (const auto& [key, value] : value_->items()) visit(key, JsonValue(*this, value, where_ + "." + key));
}

std::uint64_t JsonValue::whole(std::uint64_t most) const {
  const auto expect = [&](bool holds) {
    if (!holds) fail(fmt::format("a whole number from 0 to {}", most));
  };
  if (value_->is_number_float()) {  // some programs write all numbers with a point
    const double number = value_->get<double>();
    expect(number >= 0 && number <= 0x1p53 && std::floor(number) == number && number <= static_cast<double>(most));
    return static_cast<std::uint64_t>(number);
  }
  expect(value_->is_number_unsigned() && value_->get<std::uint64_t>() <= most);
  return value_->get<std::uint64_t>();
}

double JsonValue::number() const {
  if (!value_->is_number()) fail("a number");
  return value_->get<double>();
}

const std::string& JsonValue::text() const {
  if (!value_->is_string()) fail("a text");
  return value_->get_ref<const std::string&>();
}

std::string JsonValue::text_of(const char* key) const {
  const std::optional<JsonValue> found = find(key);
  return found && found->is_text() ? found->text() : std::string();
}

std::size_t JsonList::index_of(const JsonValue& index) const {
  const std::size_t count = size();
  if (count == 0) index.fail(fmt::format("a file with \"{}\"", key_), "none");
  return index.whole(count - 1);
}

}  // namespace vdb_offset::io::gltf
