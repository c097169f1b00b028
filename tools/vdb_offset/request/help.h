// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "request/command_line.h"

namespace vdb_offset::tool {

/// What an offset is, what stands below all of its options, and below the few that --help lists first.
extern const char *const kAbout, *const kMore, *const kMoreOfFirst;

/// The options of an offset, and of `check`, by topics.
std::span<const HelpTopic> help_topics();

}  // namespace vdb_offset::tool
