// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "outputs.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/offset.h"

namespace vdb_offset::tool {

/// The words of a command line as a shell takes them.
std::string as_typed(int argc, const char* const* argv);

/// Writes the page of one offset, or of both skins of a shell. `report`: its JSON.
void write_page(const Job& job, const Outcome& outcome, const std::string& report);

/// Writes the page of layers, with the surface at each height.
/// \param quality scaled Jacobians of the cells, if they are known
void write_page(const Job& job, const LayersResult& layers, const WallNames& names, std::span<const float> quality,
                const std::string& report);

/// Writes the page of an offset that was measured, of a mesh or of curves.
void write_page(const Request& made, PolygonView source, std::span<const Vec3d> positions, const CheckResult& result,
                const io::ResultFaces& faces);

}  // namespace vdb_offset::tool
