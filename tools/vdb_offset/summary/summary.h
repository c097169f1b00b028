// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "job.h"
#include "outputs.h"
#include "summary/remarks.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::tool {

/// What --dry-run prints: the mesh's facts and the plan.
void print_dry_run(const Job& job, const OffsetStatistics& statistics, const Distances& farthest);
/// The same with --fit. \pre `statistics` are those of plan_fit()
void print_fit_dry_run(const Job& job, const OffsetStatistics& statistics);

/// Whether standard output is one of the files that are written.
bool output_is_taken(const Job& job);

/// Prints what a mesh or curves are made of.
void print_facts(std::FILE* out, const MeshFacts& facts, const Lengths& lengths, bool curves = false);

/// What is said of one output, in print and in the report: one verdict, and warnings.
Summary summary_of(const Job& job, const Outcome& outcome, const Products& made);

/// What is printed of one output; with --verbose all that is known of the mesh and the grid. Goes to standard output
/// unless the mesh does.
void print_summary(const Job& job, const Outcome& outcome, const Products& made, double total_seconds);

/// Planes by their equations, the first few of them.
std::string planes_in_words(std::span<const SymmetryPlane> planes);

// What is to be said besides the verdict.

/// Where a shell is not as it should be.
void add_shell(const ShellFacts& shell, Remarks& remarks);
/// Where it is not clear which side is outward.
void add_orientation(const Job& job, const MeshFacts& facts, Remarks& remarks);
/// What was closed or joined as it is one but for rounding, and which borders look as if they should be.
void add_seams(const SeamFacts& seams, double distance, const Lengths& lengths, Remarks& remarks);
/// What about the input may make the result wrong.
void add_input(const Job& job, const OffsetStatistics& statistics, const Distances& distances, Remarks& remarks);
/// Where the faces' error comes from: all causes that make up a quarter of it or more.
void add_faces(const Job& job, const OffsetStatistics& statistics, Remarks& remarks);
/// What is known of faces beyond the share that is certified; `faces`: how many there are in the end.
void add_certified(const CertifiedFaces& certified, std::size_t faces, Remarks& remarks);
/// What helps where the faces of an iso-surface are off.
void add_iso_cause(const FaceError& faces, Remarks& remarks);

/// A share of the area in percent, never more than it is: 100 is all of it.
std::string area_percent(double share, int digits);

/// How much of the faces is at the distance, which `asked` names. \pre faces.samples > 0
std::string faces_in_words(const FaceError& faces, const std::string& asked, bool curves);

/// What is proven of the faces.
std::string certified_in_words(const CertifiedFaces& certified, const Lengths& lengths);

/// Whether what is proven of an offset's faces is enough: they were not too many, and the share that is `asked` for is
/// within the tolerance. Says why not.
bool is_certified(const CertifiedFaces& certified, std::optional<double> asked, const std::string& offset,
                  const Lengths& lengths);

/// How many faces a mesh has.
std::size_t faces_in(const MeshFacts& facts);

/// How much of the faces of layers is at their heights: a line.
std::string layers_faces_in_words(const FaceError& outermost, const FaceError& first, bool curves);

/// Whether 99 % of the faces of an offset, by area, are within a bound, in percent of the distance. Says so if not.
bool are_within(const FaceError& faces, double percent, const std::string& offset);

/// Where the input may not have the side that is meant, and the options that settle it: a line each, without its end.
std::vector<std::string> side_hints(const Job& job, const SideRoom& room);

/// What --dry-run prints with --mode iso.
void print_iso_dry_run(const Job& job, const IsoStatistics& statistics, double distance);

/// What is said of an iso-surface, and of what was made of it.
Summary summary_of(const Job& job, const std::string& path, double distance, const IsoResult& iso,
                   const IsoProducts& made);
/// What is printed of it.
void print_iso_summary(const Job& job, const std::string& path, double distance, const IsoResult& iso,
                       const IsoProducts& made, double total_seconds);

/// What `check` says of a pair.
Summary summary_of(const Request& made, const CheckResult& result, bool curves);
/// What it prints: a table.
void print_check(std::FILE* out, const Request& made, const CheckResult& result, bool curves);

/// What is said of layers.
Summary summary_of(const Job& job, const LayersResult& result, const LayerReport& report);
/// What is printed of layers.
void print_layers_summary(const Job& job, const LayersResult& result, const LayerReport& report, double total_seconds);

}  // namespace vdb_offset::tool
