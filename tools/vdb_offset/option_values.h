#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "args.h"
#include "vdb_offset/io/iso_file.h"

namespace vdb_offset::tool {

/// \throw UsageError with the message unless the condition holds.
void require(bool holds, const std::string& message);

/// The number of an option that may be left out, above one bound and up to another. `expected` says in words which
/// numbers it takes. \throw UsageError
std::optional<double> parse_number(const char* option, const std::optional<std::string>& text, const char* expected,
                                   double above, double most);

/// The bytes of --max-memory, with an optional suffix K, M, G or T (binary), as in "4G" or "1.5 GiB". \throw UsageError
std::size_t parse_size(const std::string& text);

/// 'uv', 'color' and 'material', separated by commas, or 'none', of --transport. \throw UsageError
io::TransportRequest parse_transport(const std::string& text);

}  // namespace vdb_offset::tool
