// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vdb_offset::io::gltf {

/// A value of a file's JSON text that knows where it stands, for messages: `accessors[3].count`.
class JsonValue {
 public:
  /// Both outlive the value.
  JsonValue(const std::string& file, const nlohmann::json& value) : file_(&file), value_(&value) {}

  const std::string& where() const { return where_; }
  bool is_object() const { return value_->is_object(); }
  bool is_text() const { return value_->is_string(); }
  bool is_true() const { return value_->is_boolean() && value_->get<bool>(); }

  /// What an object has under a key. \throw InvalidInput if it is no object
  std::optional<JsonValue> find(const char* key) const;
  JsonValue at(const char* key) const;
  /// The elements of an array. \throw InvalidInput if it is none, or shorter
  std::size_t size() const;
  JsonValue operator[](std::size_t i) const;
  /// Calls visit(key, value) for all that an object has. \throw InvalidInput if it is none
  void for_each(const std::function<void(const std::string&, const JsonValue&)>& visit) const;

  /// \throw InvalidInput unless it is a whole number from 0 to `most`.
  std::uint64_t whole(std::uint64_t most) const;
  double number() const;
  const std::string& text() const;
  /// The text under a key; "" if there is none.
  std::string text_of(const char* key) const;

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;
  /// As fail(); what was found is the value itself.
  [[noreturn]] void fail(const std::string& expected) const;

 private:
  JsonValue(const JsonValue& parent, const nlohmann::json& value, std::string where)
      : file_(parent.file_), value_(&value), where_(std::move(where)) {}

  const std::string* file_;
  const nlohmann::json* value_;
  std::string where_;
};

/// The elements of a list at the top of a file, which may lack it.
class JsonList {
 public:
  JsonList(const JsonValue& root, const char* key) : key_(key), root_(root), list_(root.find(key)) {}

  std::size_t size() const { return list_ ? list_->size() : 0; }
  /// The element that an index names. \throw InvalidInput at the index, if there is no such element
  JsonValue at(const JsonValue& index) const { return (*this)[index_of(index)]; }
  JsonValue operator[](std::size_t i) const { return (*list_)[i]; }
  std::size_t index_of(const JsonValue& index) const;

 private:
  const char* key_;
  JsonValue root_;
  std::optional<JsonValue> list_;
};

/// Where values stand in a JSON text that a parser has accepted. A parsed text does not know, and cannot be written
/// again as it was.
class JsonText {
 public:
  /// Values may be nested in so many others: no file of a model needs as many.
  static constexpr std::size_t kDeepest = 200;

  explicit JsonText(std::string_view text) : text_(text) {}

  /// How deep values are nested, in a text that need not be JSON.
  std::size_t depth() const;

  /// Where the text's own value begins.
  std::size_t root() const { return skip_blanks(0); }
  /// Where the value begins that the object at a byte has under a key; the last of several, as parsers take it.
  std::optional<std::size_t> member(std::size_t object, std::string_view key) const;
  /// Where the elements of the array at a byte begin.
  std::vector<std::size_t> elements(std::size_t array) const;
  /// The byte behind the value that begins at a byte.
  std::size_t end_of(std::size_t value) const;

 private:
  std::size_t skip_blanks(std::size_t at) const;
  std::size_t end_of_string(std::size_t at) const;
  bool is_key(std::size_t at, std::size_t end, std::string_view key) const;

  std::string_view text_;
};

/// Bytes of a text that become others.
struct Replacement {
  std::size_t begin, end;
  std::string text;
};

/// The text with replacements, which are in its order and apart.
std::string replaced(std::string_view text, const std::vector<Replacement>& replacements);

}  // namespace vdb_offset::io::gltf
