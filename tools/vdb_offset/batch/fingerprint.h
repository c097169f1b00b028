// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace vdb_offset::tool {

/// 128 bits that stand for a text, as hexadecimal digits.
std::string fingerprint_of(std::string_view text);

/// 128 bits that stand for words and for the contents of files: whatever changes in them, changes these. What is no
/// regular file, or cannot be read, counts as such. Ends early, with a meaningless result, once a stop is asked for.
std::string fingerprint_of(std::span<const std::string> words, std::span<const std::string> files);

/// 128 bits that stand for words and for what the system notes of files: as long as they stay, so do the contents.
std::string stamp_of(std::span<const std::string> words, std::span<const std::string> files);

}  // namespace vdb_offset::tool
