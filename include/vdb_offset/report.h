// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// How near the vertices in use are to their target distances.
struct AchievedSummary {
  std::size_t vertices = 0;  ///< In use.
  double share_reached = 0;
  double asked_least = 0, asked_mean = 0, asked_most = 0;                ///< Signed, world units.
  double least = 0, mean = 0, most = 0;                                  ///< Achieved distance, world units.
  double quantile_01 = 0, quantile_05 = 0, median = 0, quantile_95 = 0;  ///< Of the achieved distance.
  double worst_reached_error = 0;  ///< Largest |achieved - target| / target among the reached.
};
VDB_OFFSET_API AchievedSummary summarise(std::span<const VertexState> states, std::span<const double> achieved,
                                         const Distances& distances);
VDB_OFFSET_API AchievedSummary summarise(const OffsetResult& result);

/// A level set that was written of an iso-surface.
struct LevelSetFacts {
  std::size_t active_voxels = 0;
  double voxel_size = 0;  ///< World units.
};

/// What a run says of its result in words.
struct RunSummary {
  struct Warning {
    std::string kind;  ///< "wrong": the result may not be what was meant; "off": it is off in places; "input": the
                       ///< input has a fault that was left as it is.
    std::string text;
  };
  std::string verdict;             ///< Empty: nothing was said.
  std::vector<Warning> warnings;   ///< The gravest first.
  std::vector<std::string> notes;  ///< What is not a reason to worry.
};

/// What a report adds to a result: what was asked for, and where.
struct RunFacts {
  std::string input, output;
  std::string distance_text;  ///< The distance as the user gave it.
  double total_seconds = 0;
  std::optional<ShellFacts> shell;             ///< If a shell was written.
  std::optional<CadFileFacts> cad;             ///< If a CAD model was written.
  std::optional<IsoStatistics> inner_surface;  ///< If a hollow solid was written that has two captured skins.
  std::optional<LayerReport> layers;           ///< If layers were written.
  std::optional<LevelSetFacts> level_set;      ///< If a level set was written, in place of the surface's mesh.
  std::vector<std::pair<std::string, std::string>> options;  ///< Every option's name and value in force.
  RunSummary summary;
};

/// The report of a run as JSON text; the keys are documented in docs/report.md.
VDB_OFFSET_API std::string report_json(const OffsetResult& result, const RunFacts& run);
/// The report of layers as JSON text: figures about vertices are those of the outermost surface.
VDB_OFFSET_API std::string report_json(const LayersResult& result, const RunFacts& run);

/// The report of an iso-surface as JSON text.
VDB_OFFSET_API std::string report_json(const IsoStatistics& statistics, const RunFacts& run);

/// The findings of a check as JSON text, with the keys of report_json() where they mean the same.
VDB_OFFSET_API std::string check_json(const CheckResult& result, const std::string& source, const std::string& offset,
                                      const RunSummary& summary = {});

}  // namespace vdb_offset
