// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
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
/// \param wall that they were grown on, if it is not the source \param quality scaled Jacobians of the cells, if they
/// are known
void write_page(const Job& job, std::optional<PolygonView> wall, const LayersResult& layers, const WallNames& names,
                std::span<const float> quality, const std::string& report);

/// Writes the page of an offset that was measured, of a mesh or of curves.
void write_page(const Request& made, const Source& source, std::span<const Vec3d> positions, const CheckResult& result,
                const io::ResultFaces& faces);

/// Writes the page of a mesh, or of curves, alone.
void write_page(const Request& made, const Source& source);
/// Writes the page of a mesh and of one with other faces, or of curves. `remark`: why nothing is known of it.
void write_page(const Request& made, const Source& source, PolygonView result, const std::string& remark);

}  // namespace vdb_offset::tool
