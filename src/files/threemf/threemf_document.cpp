// SPDX-License-Identifier: Apache-2.0
// 3MF packages: meshes out of them, and back into them with all else as it was.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <utility>

#include "bytes/nearest_names.h"
#include "bytes/scanner.h"
#include "derived/derived_mesh.h"
#include "document/document.h"
#include "document/format_readers.h"
#include "ground/system/memory.h"
#include "threemf/derived_part.h"
#include "threemf/package.h"
#include "threemf/slicer_names.h"
#include "threemf/vertex_text.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr const char* kTriangleColours = "colours of triangles";

class ThreeMfDocument : public Document {
 public:
  explicit ThreeMfDocument(const MeshFile& file)
      : path_(file.path), bytes_(file.bytes), archive_(path_, bytes_.view()) {}

  /// Fills in the file's mesh.
  void read(MeshFile& file) {
    ThreeMfScene scene = read_scene(path_, archive_);
    file.unit_micrometres = scene.parts[0].model.unit_micrometres;
    name_extras(scene, file);
    place_meshes(scene, file.polygons);
    find_touching(scene, file);
    // Where an object is placed, digits of the numbers in its frame are not those of the scene, on which validity is
    // judged: such a file gets as many as there are.
    for (const PlacedMesh& mesh : scene.meshes)
      if (!mesh.transform.is_identity()) file.encoding = Encoding::LittleEndian;
    if (file.polygons.face_count() == 0)
      throw InvalidInput(scene.parts[0].label +
                         ": expected an item in 'build' that places a mesh of triangles, got none");
    for (ThreeMfPart& part : scene.parts)
      parts_.push_back({part.entry, std::move(part.label), std::move(part.model.vertex_at),
                        !part.model.materials.empty(), !part.model.colours.empty()});
    meshes_ = std::move(scene.meshes);
    groups_ = std::move(scene.groups);
    volumes_ = std::move(scene.volumes);
  }

  WrittenDocument rewrite(const MovedMesh& moved) const override;
  bool takes_faces() const override { return true; }
  WrittenDocument derive(const SharedDerived& derived, const std::string& path) const override;
  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  FaceNames face_names() const override;

 private:
  struct Part {
    const ZipEntry* entry;
    std::string label;
    std::vector<std::uint64_t> vertex_at;
    bool has_materials, has_colours;
  };

  void name_extras(const ThreeMfScene& scene, MeshFile& file) const;
  static void place_meshes(const ThreeMfScene& scene, Polygons& polygons);
  static void find_touching(const ThreeMfScene& scene, MeshFile& file);
  /// Calls visit(mesh, model) for all meshes of the parts for which wanted(part) holds; the models have properties.
  template <class Wanted, class Visit>
  void visit_properties(Wanted&& wanted, Visit&& visit) const;

  std::string path_;
  FileBytes bytes_;
  ZipArchive archive_;
  std::vector<Part> parts_;
  std::vector<PlacedMesh> meshes_;
  std::vector<std::string> groups_;
  std::vector<NamedFaces> volumes_;
};

void ThreeMfDocument::place_meshes(const ThreeMfScene& scene, Polygons& polygons) {
  std::size_t vertices = 0, faces = 0;
  for (const PlacedMesh& mesh : scene.meshes) vertices += mesh.vertices, faces += mesh.faces;
  require_memory(vertices * sizeof(Vec3d) + 4 * faces * sizeof(std::uint32_t), scene.parts[0].label);
  if (vertices >= kNone || 3 * faces >= kNone)
    throw InvalidInput(fmt::format("{}: expected fewer than {} vertices and corners, got {} and {}",
                                   scene.parts[0].label, kNone, vertices, 3 * faces));
  polygons.positions.reserve(vertices);
  polygons.corners.reserve(3 * faces);
  polygons.face_begin.reserve(faces + 1);
  for (const PlacedMesh& mesh : scene.meshes) {
    const ThreeMfModel& model = scene.parts[mesh.part].model;
    for (std::size_t v = 0; v < mesh.vertices; ++v) {
      polygons.positions.push_back(mesh.transform(model.positions[mesh.first_in_part + v]));
      if (!polygons.positions.back().isFinite())
        throw InvalidInput(fmt::format("{}: expected finite positions, got others where object {} is placed",
                                       scene.parts[mesh.part].label, model.objects[mesh.object].id));
    }
    for (std::size_t t = 0; t < mesh.faces; ++t) {
      for (std::size_t k = 0; k < 3; ++k)
        polygons.corners.push_back(
            static_cast<std::uint32_t>(mesh.first_vertex + model.triangles[mesh.first_triangle + t][mesh.corner(k)]));
      polygons.close_face();
    }
  }
}

/// Looks for vertices at the position of one of another object, or of their own.
void ThreeMfDocument::find_touching(const ThreeMfScene& scene, MeshFile& file) {
  if (scene.meshes.size() < 2) return;
  const std::vector<Vec3d>& at = file.polygons.positions;
  std::vector<std::uint32_t> mesh_of, order(at.size());
  mesh_of.reserve(order.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    mesh_of.resize(mesh_of.size() + scene.meshes[m].vertices, static_cast<std::uint32_t>(m));
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return at[a] == at[b] ? mesh_of[a] < mesh_of[b] : at[a] < at[b]; });
  std::size_t touching = 0, of_one_object = 0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (at[order[i]] != at[order[i - 1]]) continue;
    ++(mesh_of[order[i]] == mesh_of[order[i - 1]] ? of_one_object : touching);
  }
  file.has_touching_objects = touching > 0 && of_one_object == 0;
  if (touching > 0 && of_one_object > 0)
    file.remarks.push_back(
        fmt::format("objects touch at {} vertices and move as one there, as {} vertices of one object are one but for "
                    "their numbers (--weld none keeps all apart)",
                    touching, of_one_object));
}

void ThreeMfDocument::name_extras(const ThreeMfScene& scene, MeshFile& file) const {
  std::set<std::string> extras;
  std::set<const ZipEntry*> known;
  for (const ThreeMfPart& part : scene.parts) {
    extras.insert(part.model.extras.begin(), part.model.extras.end());
    if (!part.model.materials.empty()) extras.insert("colours of materials");
    if (!part.model.colours.empty()) extras.insert(kTriangleColours);
    known.insert(part.entry);
  }
  if (scene.meshes.size() != 1 || !scene.meshes[0].transform.is_identity())
    file.extras.emplace_back("objects and their places");
  file.extras.insert(file.extras.end(), extras.begin(), extras.end());
  std::vector<std::string> others;
  for (const ZipEntry& entry : archive_.entries())
    if (!known.contains(&entry) && !entry.name.ends_with(".rels") && entry.name != "[Content_Types].xml" &&
        !entry.name.ends_with('/'))
      others.push_back(in_short(entry.name, 80));
  if (!others.empty()) file.extras.push_back(fmt::format("the package's other parts ({})", first_names(others)));

  file.remarks.insert(file.remarks.end(), scene.remarks.begin(), scene.remarks.end());
  const auto remark = [&](std::size_t count, const char* one, const char* several) {
    if (count > 0) file.remarks.push_back(count == 1 ? std::string(one) : fmt::format("{} {}", count, several));
  };
  remark(scene.repeated,
         "an object is placed twice: it is moved where it stands first, and is the same in the other place",
         "places hold an object that stands elsewhere, too: it is moved where it stands first, and is the same in all");
  remark(scene.unplaced, "an object that is placed nowhere stays as it is",
         "objects that are placed nowhere stay as they are");
  remark(scene.left, "an object stays as it is: a support, or one that is not printed",
         "objects stay as they are: supports, or such that are not printed");
}

WrittenDocument ThreeMfDocument::rewrite(const MovedMesh& moved) const {
  std::vector<ZipArchive::Replacement> replacements;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    std::vector<PlacedMesh> meshes;
    for (const PlacedMesh& mesh : meshes_)
      if (mesh.part == p) meshes.push_back(mesh);
    bool any = false;
    for (const PlacedMesh& mesh : meshes)
      for (std::size_t v = mesh.first_vertex; v < mesh.first_vertex + mesh.vertices && !any; ++v)
        any = moved.has_moved(v);
    if (!any) continue;
    const std::string text = archive_.read(*parts_[p].entry);
    const Pieces pieces = with_moved_vertices(text, parts_[p].vertex_at, std::move(meshes), moved);
    replacements.push_back({parts_[p].entry, pack(parts_[p].label, pieces, parts_[p].entry->method)});
  }
  WrittenDocument written;
  if (replacements.empty()) written.file = {1, [bytes = bytes_](std::size_t) { return std::string(bytes.view()); }};
  else written.file = archive_.with(std::move(replacements));
  return written;
}

WrittenDocument ThreeMfDocument::derive(const SharedDerived& derived, const std::string& path) const {
  std::vector<std::string> remarks;  // have been reported
  const SlicerNames names = read_slicer_names(path_, archive_, remarks);
  WrittenDocument written;
  std::vector<ZipArchive::Replacement> replacements;
  const std::size_t count = derived->source_vertices();
  const MovedMesh moved{derived->source(), derived->mesh().positions.first(count), derived->precision(), {}, path};
  std::vector<DerivedObject> objects = split_by_objects(*derived, meshes_);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const std::string text = archive_.read(*parts_[p].entry);
    const ThreeMfModel model = read_model(parts_[p].label, text, true);
    std::vector<DerivedObject> of_part;
    for (DerivedObject& object : objects)
      if (object.placed.part == p) of_part.push_back(std::move(object));
    if (of_part.empty()) continue;
    for (DerivedObject& object : of_part) {
      const auto volumes = names.volumes.find(model.objects[object.placed.object].id);
      order_triangles(*derived, model, object, p == 0 && volumes != names.volumes.end() ? &volumes->second : nullptr);
      if (model.extras.contains("elements 'trianglesets' of meshes") && !object.keeps_numbers)
        written.lost.emplace_back("which triangles sets of them hold");
    }
    const Pieces pieces = derived_part(text, model, *derived, of_part, moved);
    replacements.push_back({parts_[p].entry, pack(parts_[p].label, pieces, parts_[p].entry->method)});
    if (p > 0 || names.volumes.empty()) continue;
    std::string settings = with_volumes(archive_.read(*names.settings), names, model, of_part);
    replacements.push_back(
        {names.settings, pack(path_, {1, [&](std::size_t) { return settings; }}, names.settings->method)});
  }
  written.file = archive_.with(std::move(replacements));
  return written;
}

template <class Wanted, class Visit>
void ThreeMfDocument::visit_properties(Wanted&& wanted, Visit&& visit) const {
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (!wanted(parts_[p])) continue;
    const ThreeMfModel model = read_model(parts_[p].label, archive_.read(*parts_[p].entry), true);
    for (const PlacedMesh& mesh : meshes_)
      if (mesh.part == p) visit(mesh, model);
  }
}

FaceNames ThreeMfDocument::face_names() const {
  FaceNames names;
  names.groups = groups_;
  for (const PlacedMesh& mesh : meshes_) names.group_of.resize(names.group_of.size() + mesh.faces, mesh.group);
  for (const NamedFaces& volume : volumes_)
    std::fill_n(names.group_of.begin() + static_cast<std::ptrdiff_t>(volume.first), volume.count, volume.group);
  std::map<std::string, std::uint32_t> known{{"", 0}};
  const auto index_of = [&](const std::string& name) {
    return known.try_emplace(name, static_cast<std::uint32_t>(known.size())).first->second;
  };
  std::vector<std::uint32_t> material_of(names.group_of.size(), 0);
  visit_properties([](const Part& part) { return part.has_materials; },
                   [&](const PlacedMesh& mesh, const ThreeMfModel& model) {
                     for (std::size_t t = 0; t < mesh.faces; ++t) {
                       const ThreeMfProperty& property = model.properties[mesh.first_triangle + t];
                       const auto group = model.materials.find(property.group);
                       if (group != model.materials.end() && property.index[0] < group->second.size())
                         material_of[mesh.first_face + t] = index_of(group->second[property.index[0]]);
                     }
                   });
  if (known.size() == 1) return names;
  names.materials.resize(known.size());
  for (const auto& [name, index] : known) names.materials[index] = name;
  names.material_of = std::move(material_of);
  return names;
}

void ThreeMfDocument::read_attributes(const MeshFile& source, Attributes& attributes) const {
  if (std::none_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.has_colours; })) return;
  constexpr std::array<double, 4> kNoColour{-1, -1, -1, -1}, kWhite{1, 1, 1, 1};
  std::vector<std::array<double, 4>> colours(source.polygons.positions.size(), kNoColour);
  bool agree = true, has_alpha = false;
  std::size_t faces = 0;
  visit_properties([](const Part& part) { return part.has_colours; },
                   [&](const PlacedMesh& mesh, const ThreeMfModel& model) {
                     faces += mesh.faces;
                     for (std::size_t t = 0; t < mesh.faces; ++t) {
                       const ThreeMfProperty& property = model.properties[mesh.first_triangle + t];
                       const auto group = model.colours.find(property.group);
                       for (std::size_t k = 0; k < 3; ++k) {
                         const std::size_t corner = mesh.corner(k);
                         if (group == model.colours.end() || property.index[corner] >= group->second.size()) {
                           agree = false;
                           continue;
                         }
                         const auto& colour = group->second[property.index[corner]];
                         auto& known = colours[source.polygons.corners[3 * (mesh.first_face + t) + k]];
                         agree = agree && (known == kNoColour || known == colour);
                         known = colour;
                         has_alpha = has_alpha || colour[3] != 1;
                       }
                     }
                   });
  if (!agree || faces != source.polygons.face_count()) return;
  std::replace(colours.begin(), colours.end(), kNoColour, kWhite);
  attributes.colours = std::move(colours);
  attributes.has_alpha = has_alpha;
  std::erase(attributes.lost, kTriangleColours);
}

}  // namespace

void parse_3mf(MeshFile& file) {
  const auto document = std::make_shared<ThreeMfDocument>(file);
  document->read(file);
  file.document = document;
}

std::optional<double> unit_of_3mf(const std::string& path) {
  if (path == "-") return std::nullopt;  // standard input can be read once
  const FileBytes bytes = FileBytes::open(path);
  const ZipArchive archive(path, bytes.view());
  const ZipEntry& entry = first_part(path, archive);
  constexpr std::size_t kBeginning = 1 << 16;  // bytes; far more than stand before the end of the first tag
  return unit_of_model(fmt::format("{}: {}", path, in_short(entry.name, 80)),
                       archive.read_beginning(entry, kBeginning));
}

}  // namespace vdb_offset::io
