// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "threemf/zip_archive.h"

namespace vdb_offset::io {

/// What slicers call objects, in settings beside the model: PrusaSlicer in Metadata/Slic3r_PE_model.config, BambuStudio
/// and OrcaSlicer in Metadata/model_settings.config.
struct SlicerNames {
  /// Triangles of an object's mesh, from the first to the last.
  struct Volume {
    std::size_t first, last;
    std::string name;
    std::size_t at;  ///< First byte of its element.
  };
  const ZipEntry* settings = nullptr;              ///< What they stand in.
  std::map<std::uint32_t, std::string> of_object;  ///< By the id of the object that an item places.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> of_part;  ///< By that, and by the component's.
  std::map<std::uint32_t, std::vector<Volume>> volumes;                    ///< By the object's id.
};

/// None if there are no such settings, or if they cannot be read: then `remarks` says so.
SlicerNames read_slicer_names(const std::string& path, const ZipArchive& archive, std::vector<std::string>& remarks);

}  // namespace vdb_offset::io
