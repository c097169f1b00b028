// SPDX-License-Identifier: Apache-2.0
// A CAD model as a mesh: each of its faces is a group.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "bytes/compression.h"
#include "bytes/nearest_names.h"
#include "cad/cad_surface.h"
#include "cad/cad_worker.h"
#include "document/document.h"
#include "document/format_readers.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// Six hexadecimal digits.
std::string colour_digits(const std::array<double, 3>& colour) {
  return fmt::format("{:02x}{:02x}{:02x}", colour_byte(colour[0]), colour_byte(colour[1]), colour_byte(colour[2]));
}

/// A name without blanks, as the names of groups are words.
std::string one_word(std::string name) {
  for (char& c : name)
    if (std::isspace(static_cast<unsigned char>(c))) c = '_';
  return name;
}

std::string group_of(const CadFaceFacts& face, std::size_t number) {
  std::string group = fmt::format("face_{}", number);
  for (const std::string* name : {&face.instance, &face.name})
    if (!name->empty()) group += "_" + one_word(*name);
  return group;
}

class CadDocument : public Document {
 public:
  CadDocument(std::shared_ptr<const CadMesh> mesh) : mesh_(std::move(mesh)) {}

  WrittenDocument rewrite(const MovedMesh& moved) const override {
    throw InvalidInput(moved.path + ": expected a format that can be written, got one that is read only");
  }

  void read_attributes(const MeshFile&, Attributes& attributes) const override {
    const auto scaled = [](double at, const std::array<double, 2>& range) {
      return range[1] > range[0] ? (at - range[0]) / (range[1] - range[0]) : 0;
    };
    // Corners of one face at one place have one entry.
    std::map<std::array<double, 2>, std::uint32_t> known;
    auto& [value, of_corner, single] = attributes.texture;
    value.clear();
    of_corner.clear();
    single = false;
    for (std::size_t c = 0; c < mesh_->corner_parameters.size(); ++c) {
      if (c > 0 && mesh_->face_of[c / 3] != mesh_->face_of[(c - 1) / 3]) known.clear();
      const auto [entry, is_new] =
          known.try_emplace(mesh_->corner_parameters[c], static_cast<std::uint32_t>(value.size()));
      const CadFaceFacts& face = mesh_->faces[mesh_->face_of[c / 3]];
      if (is_new) value.emplace_back(scaled(entry->first[0], face.u), scaled(entry->first[1], face.v));
      of_corner.push_back(entry->second);
    }
  }

  FaceNames face_names() const override {
    FaceNames names;
    std::map<std::string, std::uint32_t> known;
    std::vector<std::uint32_t> material_of;
    for (std::size_t f = 0; f < mesh_->faces.size(); ++f) {
      const CadFaceFacts& face = mesh_->faces[f];
      names.groups.push_back(group_of(face, f + 1));
      names.layers.push_back(one_word(face.layer));
      const std::string material = face.colour ? "rgb_" + colour_digits(*face.colour) : "";
      const auto [entry, is_new] = known.try_emplace(material, static_cast<std::uint32_t>(names.materials.size()));
      if (is_new) names.materials.push_back(material), names.colours.push_back(face.colour);
      material_of.push_back(entry->second);
    }
    names.group_of = mesh_->face_of;
    if (names.materials.size() > 1 || !names.materials.front().empty())
      for (const std::uint32_t f : mesh_->face_of) names.material_of.push_back(material_of[f]);
    else names.materials.clear(), names.colours.clear();
    return names;
  }

  std::optional<std::vector<std::uint8_t>> select(const MeshFile& source, const Selector& selector) const override {
    std::vector<std::uint8_t> of_face(mesh_->faces.size(), 0);
    std::vector<std::string> known;
    for (std::size_t f = 0; f < of_face.size(); ++f)
      for (const std::string& name : names_of(f, selector.by)) {
        known.push_back(name);
        if (name == selector.name) of_face[f] = 1;
      }
    if (std::find(of_face.begin(), of_face.end(), 1) == of_face.end()) fail(source, selector, std::move(known));
    std::vector<std::uint8_t> marks;
    for (const std::uint32_t f : mesh_->face_of) marks.push_back(of_face[f]);
    return marks;
  }

 private:
  std::vector<std::string> names_of(std::size_t f, Selector::By by) const {
    const CadFaceFacts& face = mesh_->faces[f];
    std::vector<std::string> names;
    if (by == Selector::By::Face) names = {std::to_string(f + 1)};
    else if (by == Selector::By::Name) names = names_around(face);
    else if (face.colour) names = {colour_digits(*face.colour)};
    std::erase(names, "");
    return names;
  }

  static std::vector<std::string> names_around(const CadFaceFacts& face) {
    std::vector<std::string> names = face.within;
    names.insert(names.end(), {face.name, face.layer, face.solid});
    return names;
  }

  [[noreturn]] void fail(const MeshFile& source, const Selector& selector, std::vector<std::string> known) const {
    if (selector.by == Selector::By::Face)
      throw InvalidOption(
          fmt::format("{}: expected a face from 1 to {}, got '{}'", source.path, mesh_->faces.size(), selector.name));
    const char* const kind = selector.by == Selector::By::Name ? "name" : "color";
    if (known.empty()) throw InvalidOption(fmt::format("{} has no {}s: '{}'", source.path, kind, selector.name));
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    throw InvalidOption(fmt::format("{}: expected a {} among {}, got '{}'", source.path, kind,
                                    nearest_names(selector.name, {known.begin(), known.end()}), selector.name));
  }

  std::shared_ptr<const CadMesh> mesh_;
};

CadMeshing meshing_of(const CadReading& how) {
  return {{how.deflection, how.deflection > 0 ? 0 : how.deflection_share, how.angle_degrees * std::numbers::pi / 180,
           how.least_share, how.most_share},
          how.fuses_bodies};
}

}  // namespace

void parse_cad(MeshFile& file, const CadReading& how) {
  CadWorker worker(file.path, file.text(), name(file.format), meshing_of(how), how.seconds, memory_limit(),
                   how.progress);
  const auto mesh = std::make_shared<const CadMesh>(worker.take_mesh());
  file.polygons.positions = mesh->positions;
  for (const auto& triangle : mesh->triangles) file.polygons.add_face({triangle[0], triangle[1], triangle[2]});
  file.extras = mesh->extras;
  file.remarks = mesh->remarks;
  file.encoding = Encoding::LittleEndian;
  if (mesh->has_unit) file.unit_micrometres = mesh->unit_micrometres;
  file.document = std::make_shared<CadDocument>(mesh);
  file.exact = std::make_shared<CadSurface>(mesh, std::move(worker));
}

}  // namespace vdb_offset::io
