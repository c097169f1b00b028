// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vdb_offset::io::gltf {

/// A `data:` URI in base64.
struct DataUri {
  std::string head;   ///< Up to the data, "base64," included.
  std::string bytes;  ///< Decoded.
  bool padded;        ///< Whether `=` fills it up, as far as one can see.
};

bool is_data_uri(std::string_view uri);
/// None if it is no such URI.
std::optional<DataUri> parse_data_uri(std::string_view uri);
std::string base64(std::string_view bytes, bool padded = true);

/// The relative path that a URI stands for, %20 and the like decoded. None if it has a scheme, is absolute or is not a
/// path that a file can have.
std::optional<std::string> relative_path(std::string_view uri);
/// The URI of a relative path.
std::string as_uri(std::string_view path);

}  // namespace vdb_offset::io::gltf
