// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "request/request.h"

namespace vdb_offset::tool {

/// What each of some options needs or excludes. A name alone is the option with any value, "--mode iso" with that one.
struct OptionRule {
  enum class Relation { NeedsAnyOf, NeedsOneOf, Excludes };
  std::vector<std::string> options;
  Relation relation;
  std::vector<std::string> others;
};

/// \throw UsageError for the first rule that what was given breaks
void require_rules(const GivenNames& given, const std::vector<OptionRule>& rules);

/// The rules of an offset. \throw UsageError
void require_together(const GivenNames& given);

/// \throw UsageError if values do not go together, or a file's name has no ending that says what it is to hold. What
/// depends on whether INPUT holds curves is for require_for_input().
void require_sound(const Request& request);
/// Requires an ending that files of states have; check's rule as well. \throw UsageError
void require_states_file(const Request& request);

/// \throw UsageError unless --html names a page, InvalidOption if this build has none
void require_page(const Request& request);
/// Requires miters where there is a limit of them; check's rule as well. \throw UsageError
void require_miters(const Request& request);
/// Refuses options about faces for curves, where `meshes` are expected, and those about curves for meshes; check's rule
/// as well. \throw UsageError
void require_options_for(const Request& request, bool curves, const char* meshes);

}  // namespace vdb_offset::tool
