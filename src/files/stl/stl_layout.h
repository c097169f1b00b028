// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "bytes/scanner.h"

/// How STL files are laid out.
namespace vdb_offset::io::stl {

/// Bytes of a binary file: its header, all in front of the first facet, a facet, and in it what is in front of the
/// first corner and of the attribute bytes.
inline constexpr std::size_t kHeader = 80, kFirst = 84, kFacet = 50, kNormal = 12, kAttribute = 48;

/// Skips words behind the end of a loop or a facet: some writers add remarks there.
inline void skip_remark(Scanner& scanner) {
  const std::string_view next = Scanner(scanner).token();
  if (!next.starts_with("end") && !next.starts_with("END") && !is_word(next, "facet")) scanner.next_line();
}

}  // namespace vdb_offset::io::stl
