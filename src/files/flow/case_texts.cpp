// SPDX-License-Identifier: Apache-2.0
#include "flow/case_texts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

bool has_text(const std::filesystem::path& path, const std::string& text) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) != text.size() || error) return false;
  std::string there(text.size(), '\0');
  return std::ifstream(path, std::ios::binary).read(there.data(), static_cast<std::streamsize>(there.size())) &&
         there == text;
}

}  // namespace

void require_flow(std::span<const CasePatch> patches, const Flow& flow) {
  if (!(flow.viscosity > 0) || !(flow.speed > 0) || !(flow.length > 0))
    throw InvalidInput("case: expected a speed, a length and a viscosity above 0");
  std::vector<std::string> unknown;
  for (const CasePatch& patch : patches)
    if (patch.kind == BoundaryPatch::Kind::Side) unknown.push_back(patch.name);
  if (!unknown.empty())
    throw InvalidInput(
        fmt::format("case: expected inlets, outlets, walls, planes of symmetry or a farfield, got sides: {}",
                    fmt::join(unknown, ", ")));
  std::set<std::string> names;
  for (const CasePatch& patch : patches)
    if (!is_patch_word(patch.name) || !names.insert(patch.name).second)
      throw InvalidInput(fmt::format(
          "case: expected patches with names that differ, of letters, digits and . _ + -, got '{}'", patch.name));
}

Vec3d direction_of(const Flow& flow) {
  Vec3d direction = flow.direction;
  if (!direction.normalize()) throw InvalidInput("case: expected a direction of the flow, got none");
  return direction;
}

const char* in_words(BoundaryPatch::Kind kind) {
  switch (kind) {
    case BoundaryPatch::Kind::Wall:
      return "a wall without slip";
    case BoundaryPatch::Kind::Inlet:
      return "an inlet with the flow's speed across it";
    case BoundaryPatch::Kind::Outlet:
      return "an outlet at pressure 0";
    case BoundaryPatch::Kind::Symmetry:
      return "a plane of symmetry";
    case BoundaryPatch::Kind::Periodic:
      return "one of two that the flow goes on through";
    case BoundaryPatch::Kind::Empty:
      return "the two ends of a plane flow";
    default:
      return "far away";
  }
}

std::string flow_in_words(const Flow& flow) {
  return fmt::format(
      "A steady, laminar flow at speed {:.6g} with kinematic viscosity {:.6g}; lengths are the mesh's.\n", flow.speed,
      flow.viscosity);
}

std::string conditions_in_words(std::span<const CasePatch> patches) {
  std::string text;
  for (const CasePatch& patch : patches) text += fmt::format("    {}: {}\n", patch.name, in_words(patch.kind));
  return text;
}

CaseFiles write_where_missing(const std::string& folder, std::span<const CaseText> files) {
  CaseFiles all;
  OutputFiles outputs;
  for (const auto& [name, text] : files) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    if (std::filesystem::exists(path)) {
      if (!has_text(path, text)) all.kept.push_back(path.string());
      continue;
    }
    outputs.add_folders(path.parent_path());
    write_file(path.string(), text);
    all.written.push_back(path.string());
  }
  outputs.commit();
  return all;
}

}  // namespace vdb_offset::io
