#pragma once

#include <string>
#include <vector>

#include "vdb_offset/offset.h"

namespace vdb_offset {

/// How near the vertices in use came to the target.
struct AchievedSummary {
  std::size_t vertices = 0;  ///< In use.
  double share_reached = 0;
  double least = 0, mean = 0, most = 0;                 ///< Achieved distance, world units.
  double quantile_01 = 0, quantile_05 = 0, median = 0;  ///< Of the achieved distance.
  double worst_reached_error = 0;                       ///< Largest |achieved - target| / target among the reached.
};
AchievedSummary summarise(const OffsetResult& result, double distance);

/// What a report adds to a result: what was asked for, and where.
struct RunFacts {
  std::string input, output;
  double distance = 0;        ///< World units.
  std::string distance_text;  ///< As given.
  double total_seconds = 0;
  std::vector<std::pair<std::string, std::string>> options;  ///< Every option's name and value in force.
};

/// The report of a run as JSON text; the keys are documented in the README.
std::string report_json(const OffsetResult& result, const RunFacts& run);

/// The library's version, "major.minor.patch".
const char* version();

}  // namespace vdb_offset
