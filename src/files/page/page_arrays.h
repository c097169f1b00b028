// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace vdb_offset::io {

/// The numbers of a page, little-endian, one array behind the other, each from a multiple of four bytes on.
class PageArrays {
 public:
  /// Appends an array, which the page's script finds under that name.
  void add(const std::string& name, std::span<const float> numbers);
  void add(const std::string& name, std::span<const std::uint32_t> numbers);
  void add(const std::string& name, std::span<const std::uint8_t> numbers);

  /// Of each array by its name: its type, where it begins, and how many numbers it has.
  const nlohmann::json& directory() const { return directory_; }
  /// All bytes, as gzip in base64.
  std::string packed() const;

 private:
  void begin(const std::string& name, const char* type, std::size_t count);
  void append(std::uint32_t bits);

  nlohmann::json directory_ = nlohmann::json::object();
  std::string bytes_;
};

}  // namespace vdb_offset::io
