// SPDX-License-Identifier: Apache-2.0
// Reads what a 3MF package places. From the items of its first part, components are followed from object to object,
// also into other parts, and transforms are multiplied on the way; each mesh is entered where it is placed first.
// Objects that are placed again are counted, and so are those that are no model and those that nothing places. Names
// are an object's own, or a slicer's, or those of what it is in. Vertices and faces are numbered mesh by mesh in that
// order. Components inside themselves or too deep, transforms that make a mesh flat, and parts of several units are
// refused. Each part is read once. Positions stay in the frames of their objects; they are placed in
// threemf_document.cpp.
#include "threemf/package.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bytes/scanner.h"
#include "threemf/slicer_names.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kMostNested = 64;  // components inside each other; those of programs are two or three

/// The entry of a part by its name, which begins with a slash and may have characters as %20.
const ZipEntry* find_part(const ZipArchive& archive, std::string_view name) {
  if (name.starts_with('/')) name.remove_prefix(1);
  if (const ZipEntry* const found = archive.find(name)) return found;
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i) {
    constexpr std::string_view kHex = "0123456789abcdef0123456789ABCDEF";
    const auto digit = [&](std::size_t at) { return at < name.size() ? kHex.find(name[at]) : std::string_view::npos; };
    const bool is_escape =
        name[i] == '%' && digit(i + 1) != std::string_view::npos && digit(i + 2) != std::string_view::npos;
    plain += is_escape ? static_cast<char>(digit(i + 1) % 16 * 16 + digit(i + 2) % 16) : name[i];
    if (is_escape) i += 2;
  }
  return archive.find(plain);
}

class SceneReader {
 public:
  SceneReader(const std::string& path, const ZipArchive& archive)
      : path_(path), archive_(archive), names_(read_slicer_names(path, archive, scene_.remarks)) {}

  ThreeMfScene read() {
    load(first_part(path_, archive_));
    // Items are copied: other parts are loaded meanwhile.
    for (const ThreeMfPlacement& item : std::vector(scene_.parts[0].model.items)) {
      item_ = item.object;
      place(0, item, {}, {}, 0);
    }
    for (std::size_t p = 0; p < scene_.parts.size(); ++p)
      for (std::size_t o = 0; o < states_[p].size(); ++o)
        scene_.unplaced += states_[p][o] == State::New && scene_.parts[p].model.objects[o].is_mesh;
    return std::move(scene_);
  }

 private:
  enum class State : std::uint8_t { New, Open, Done };

  std::size_t load(const ZipEntry& entry) {
    const auto [known, is_new] = part_of_.try_emplace(&entry, scene_.parts.size());
    if (!is_new) return known->second;
    ThreeMfPart part{&entry, fmt::format("{}: {}", path_, in_short(entry.name, 80)), archive_.read(entry), {}};
    part.model = read_model(part.label, part.text);
    if (!scene_.parts.empty() && part.model.unit_micrometres != scene_.parts[0].model.unit_micrometres)
      throw InvalidInput(fmt::format("{}: expected the unit of the package's first part, {}, got {}", part.label,
                                     name_of_unit(scene_.parts[0].model.unit_micrometres),
                                     name_of_unit(part.model.unit_micrometres)));
    states_.emplace_back(part.model.objects.size(), State::New);
    scene_.parts.push_back(std::move(part));
    return scene_.parts.size() - 1;
  }

  [[noreturn]] void fail(std::size_t part, std::size_t at, const std::string& expected,
                         const std::string& found) const {
    Scanner(scene_.parts[part].label, scene_.parts[part].text).fail_with(expected, found, at);
  }

  /// Places an object that part `from` names, inside others with their transform and name.
  void place(std::size_t from, const ThreeMfPlacement& placement, const ThreeMfTransform& outer, std::string_view name,
             std::size_t depth) {
    std::size_t part = from;
    if (!placement.part.empty()) {
      const ZipEntry* const entry = find_part(archive_, placement.part);
      if (!entry) fail(from, placement.at, fmt::format("a part '{}'", in_short(placement.part, 80)), "none");
      part = load(*entry);
    }
    const ThreeMfModel& model = scene_.parts[part].model;
    const auto found = model.by_id.find(placement.object);
    if (found == model.by_id.end())
      fail(from, placement.at, fmt::format("an object {} in this file", placement.object), "none");
    State& state = states_[part][found->second];
    if (state == State::Open || depth > kMostNested)
      fail(from, placement.at, fmt::format("components at most {} deep", kMostNested),
           state == State::Open ? fmt::format("object {} inside itself", placement.object) : "deeper ones");
    const ThreeMfObject& object = model.objects[found->second];
    if (object.type != "model" && object.type != "surface") {
      scene_.left += state == State::New;
      state = State::Done;
    } else if (state == State::Done) {
      ++scene_.repeated;
    } else {
      enter(part, found->second, placement, outer, name_of(object, name, depth), depth);
    }
  }

  /// An object's own name, or what a slicer calls it, or the name of what it is in.
  std::string name_of(const ThreeMfObject& object, std::string_view outer, std::size_t depth) const {
    if (!object.name.empty()) return object.name;
    if (const auto part = names_.of_part.find({item_, object.id}); depth > 0 && part != names_.of_part.end())
      return part->second;
    if (const auto known = names_.of_object.find(item_); depth == 0 && known != names_.of_object.end())
      return known->second;
    return std::string(outer);
  }

  void enter(std::size_t part, std::size_t number, const ThreeMfPlacement& placement, const ThreeMfTransform& outer,
             const std::string& name, std::size_t depth) {
    // Looked up each time, as the list grows when other parts are loaded.
    const auto object = [&]() -> const ThreeMfObject& { return scene_.parts[part].model.objects[number]; };
    const ThreeMfTransform transform = placement.transform.then(outer);
    if (!object().other.empty() && !object().is_mesh && object().components.empty())
      fail(part, object().at, "an object with a mesh or components",
           fmt::format("one with '{}'", in_short(object().other)));
    if (object().has_exact_slices)
      fail(part, object().at, "an object whose mesh is its shape", "one whose slices are (meshresolution lowres)");
    states_[part][number] = State::Open;
    if (object().is_mesh) add(part, number, transform, name);
    for (const ThreeMfPlacement& component : std::vector(object().components))
      place(part, component, transform, name, depth + 1);
    states_[part][number] = State::Done;
  }

  void add(std::size_t part, std::size_t number, const ThreeMfTransform& transform, const std::string& name) {
    const ThreeMfObject& object = scene_.parts[part].model.objects[number];
    if (!transform.is_regular())
      fail(part, object.at, "an object that transforms keep as it is", "one that they make flat");
    PlacedMesh mesh{part,
                    number,
                    0,
                    object.vertices,
                    0,
                    object.triangles,
                    object.first_vertex,
                    object.first_triangle,
                    transform,
                    group_of(name, part, object.id)};
    if (!scene_.meshes.empty()) {
      const PlacedMesh& before = scene_.meshes.back();
      mesh.first_vertex = before.first_vertex + before.vertices;
      mesh.first_face = before.first_face + before.faces;
    }
    scene_.meshes.push_back(mesh);
    if (const auto volumes = names_.volumes.find(object.id); part == 0 && volumes != names_.volumes.end())
      add_volumes(mesh, volumes->second);
  }

  /// Names the volumes of an object that is made of several.
  void add_volumes(const PlacedMesh& mesh, const std::vector<SlicerNames::Volume>& volumes) {
    if (volumes.size() < 2) return;
    for (const SlicerNames::Volume& volume : volumes)
      if (volume.last < mesh.faces && !volume.name.empty())
        scene_.volumes.push_back(
            {mesh.first_face + volume.first, volume.last - volume.first + 1, group_named(volume.name)});
  }

  std::uint32_t group_of(const std::string& name, std::size_t part, std::uint32_t id) {
    std::string words = name;
    if (words.empty() && part == 0) words = fmt::format("object {}", id);
    if (words.empty()) words = fmt::format("object {} of {}", id, scene_.parts[part].entry->name);
    return group_named(words);
  }

  std::uint32_t group_named(const std::string& name) {
    const auto [known, is_new] = groups_.try_emplace(name, static_cast<std::uint32_t>(groups_.size()));
    if (is_new) scene_.groups.push_back(name);
    return known->second;
  }

  const std::string& path_;
  const ZipArchive& archive_;
  ThreeMfScene scene_;
  SlicerNames names_;
  std::uint32_t item_ = 0;                  // the object that is placed
  std::vector<std::vector<State>> states_;  // of each part's objects
  std::map<const ZipEntry*, std::size_t> part_of_;
  std::map<std::string, std::uint32_t> groups_;
};

}  // namespace

const ZipEntry& first_part(const std::string& path, const ZipArchive& archive) {
  constexpr std::string_view kRelations = "_rels/.rels";
  const ZipEntry* const relations = archive.find(kRelations);
  if (!relations) throw InvalidInput(fmt::format("{}: expected a part {} (a 3MF package), got none", path, kRelations));
  const std::string label = fmt::format("{}: {}", path, kRelations), text = archive.read(*relations);
  const std::string target = model_part(label, text);
  if (target.empty()) throw InvalidInput(label + ": expected a relation to a 3D model, got none");
  const ZipEntry* const entry = find_part(archive, target);
  if (!entry)
    throw InvalidInput(fmt::format("{}: expected a part '{}' in the package, got none", label, in_short(target, 80)));
  return *entry;
}

ThreeMfScene read_scene(const std::string& path, const ZipArchive& archive) {
  return SceneReader(path, archive).read();
}

}  // namespace vdb_offset::io
