// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "job.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::tool {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start);

/// When a run began, and how long it took to read its input.
struct Timing {
  Clock::time_point start;
  double read_seconds;
};

/// What was made besides a mesh.
struct Products {
  std::optional<ShellFacts> shell;
  std::optional<CadFileFacts> cad;
};

/// What is written for one distance.
struct Outcome {
  const Destination& to;
  OffsetResult& result;
  const OffsetResult* inner = nullptr;  ///< The inner skin of a shell, if that was asked for.
};

/// Prints on standard error what a mesh could not be given.
void report_losses(const Request& request, const std::string& path, const io::WriteResult& written);

/// Writes the source with the faces that the offset has, and where the added vertices are, as far as that is asked for.
void write_refinement(const Request& request, const RefinedSource& refined);

/// The angle of fans over sharp edges, degrees: as given, else 60 where cells are written and no miters are asked for.
/// 0: there are none.
double fan_angle_of(const Request& request);

/// The report of a run with --layers, as JSON.
std::string layers_report(const Job& job, const LayersResult& result, const LayerReport& report,
                          Clock::time_point start);

/// What grids that are written say of the run.
std::vector<std::pair<std::string, std::string>> run_metadata(const Job& job, const Destination& to);

/// What an iso-surface has become, if it is not written as a mesh of its own.
struct IsoProducts {
  const Hollow* hollow = nullptr;
  const IsoResult* inner = nullptr;  ///< The inner skin of that, if it was made as well as the outer one.
  std::optional<LevelSetFacts> level_set{};
};

/// The report of a run with --mode iso, to where it goes.
void write_iso_report(const Job& job, const Destination& to, const IsoResult& result, Clock::time_point start,
                      const IsoProducts& made);

/// Writes report, states and mesh or shell. The mesh comes last: should anything else fail, its place holds what it
/// held before. Returns the facts of a shell, if it is one.
Products write_outputs(const Job& job, const Outcome& outcome, Clock::time_point start);

}  // namespace vdb_offset::tool
