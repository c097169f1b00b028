// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "job.h"
#include "outputs.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::tool {

/// What --dry-run prints: the mesh's facts and the plan.
void print_dry_run(const Job& job, const OffsetStatistics& statistics, const Distances& farthest);
/// The same with --fit. \pre `statistics` are those of plan_fit()
void print_fit_dry_run(const Job& job, const OffsetStatistics& statistics);

/// What is printed of one output; with --verbose all that is known of the mesh and the grid. Goes to standard output
/// unless the mesh does.
void print_summary(const Job& job, const Outcome& outcome, const Products& made, double total_seconds);

/// Planes by their equations, the first few of them.
std::string planes_in_words(std::span<const SymmetryPlane> planes);

/// Where it is not clear which side is outward, and what to do about it: a line for each doubt.
void print_orientation(std::FILE* out, const MeshFacts& facts, Orient orient);

/// What was closed or joined as it is one but for rounding, and which borders look as if they should be.
void print_seams(std::FILE* out, const SeamFacts& seams, double distance);

/// What about the input may make the result wrong.
void print_doubts(std::FILE* out, const Job& job, const OffsetStatistics& statistics, const Distances& distances);

/// How far faces are off their distance, as a part of a line.
void print_faces(std::FILE* out, const FaceError& faces, bool curves);

/// What is proven of the faces, and beside it how much could have been: where vertices are all there.
std::string certified_in_words(const CertifiedFaces& certified);

/// The same, and how many faces were made of how many: `faces` in the end. A part of a line.
void print_certified(std::FILE* out, const CertifiedFaces& certified, std::size_t faces);

/// Whether what is proven of an offset's faces is enough: they were not too many, and with `strict` all of the area is
/// within the tolerance. Says why not.
bool is_certified(const CertifiedFaces& certified, bool strict, const std::string& offset);

/// How many faces a mesh has.
std::size_t faces_in(const MeshFacts& facts);

/// How far the faces of layers are off their heights: a line.
void print_layers_faces(std::FILE* out, const FaceError& outermost, const FaceError& first, bool curves);

/// What helps where the faces of an iso-surface are off: a line.
void print_iso_cause(std::FILE* out, const FaceError& faces);

/// Why faces are off their distance, and what helps: a line with all causes that make up a quarter of it or more.
void print_face_causes(std::FILE* out, const Job& job, const OffsetStatistics& statistics);

/// Whether 99 % of the faces of an offset, by area, are within a bound, in percent of the distance. Says so if not.
bool are_within(const FaceError& faces, double percent, const std::string& offset);

/// Where the input may not have the side that is meant, and the options that settle it: a line each, without its end.
std::vector<std::string> side_hints(const Job& job, const SideRoom& room);

/// What --dry-run prints with --mode iso.
void print_iso_dry_run(const Job& job, const IsoStatistics& statistics, double distance);

/// What is printed of a iso-surface.
void print_iso_summary(const Job& job, const std::string& path, double distance, const IsoResult& result,
                       double total_seconds, const std::optional<LevelSetFacts>& level_set = {});

/// What is printed of a hollow solid; `inner` is its inner skin if that was made beside the outer one.
void print_hollow_summary(const Job& job, const std::string& path, double distance, const Hollow& hollow,
                          const IsoResult& iso, const IsoResult* inner, double total_seconds);

/// What is printed of layers.
void print_layers_summary(const Job& job, const LayersResult& result, const LayerReport& report, double total_seconds);

}  // namespace vdb_offset::tool
