// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/io/case_file.h"

namespace vdb_offset::io {

/// A file of a case: its name in the folder of that, and its text.
using CaseText = std::pair<const char*, std::string>;

/// \throw InvalidInput for numbers of the flow that are not above 0, and for patches that say nothing of it
void require_flow(std::span<const CasePatch> patches, const Flow& flow);

/// The direction of the flow far away, unit length. \throw InvalidInput if there is none
Vec3d direction_of(const Flow& flow);

/// What a kind of patch stands for in a flow.
const char* in_words(BoundaryPatch::Kind kind);

/// What a README says first, of the flow and of what forces refer to.
std::string flow_in_words(const Flow& flow);

/// What a README says last: the conditions of the patches.
std::string conditions_in_words(std::span<const CasePatch> patches);

/// Writes those files that are not there, all or none of them. \throw WriteError
CaseFiles write_where_missing(const std::string& folder, std::span<const CaseText> files);

}  // namespace vdb_offset::io
