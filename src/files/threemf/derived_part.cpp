// SPDX-License-Identifier: Apache-2.0
// Writes a model part over a mesh that is made of the package's. Each object keeps its element: vertices that moved get
// other coordinates where they stand, and others follow the last one; triangles stay, are left out or become pieces in
// their place, and the inner ones and those of a rim follow, with the properties of their parents' corners. PrusaSlicer
// has an object's volumes as runs of triangles: what comes of a volume stays within its run, and the numbers in the
// slicer's settings are new. Where an object's triangles have no property, base materials say which part they are of:
// one resource a part, and the outer skin has its first by the object's own attributes, so that its triangles keep
// their bytes. Attributes that other programs gave to a triangle stay on that alone.
#include "threemf/derived_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bytes/append_number.h"
#include "derived/refined_corners.h"
#include "ground/mesh/triangulate.h"
#include "threemf/tags.h"
#include "threemf/vertex_text.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

using Triangle = DerivedObject::Triangle;
using Run = DerivedObject::Run;

bool is_own(const PlacedMesh& mesh, std::uint32_t v) {
  return v >= mesh.first_vertex && v < mesh.first_vertex + mesh.vertices;
}

std::uint32_t source_face(const PlacedMesh& mesh, std::size_t t) {
  return static_cast<std::uint32_t>(mesh.first_face + t);
}

class PartText {
 public:
  PartText(std::string_view text, const ThreeMfModel& model, const DerivedMesh& derived, const MovedMesh& moved)
      : text_(text), model_(model), derived_(derived), moved_(moved) {}

  Pieces run(const std::vector<DerivedObject>& objects) const {
    std::vector<const DerivedObject*> in_order;
    std::vector<PlacedMesh> meshes;
    for (const DerivedObject& object : objects) {
      in_order.push_back(&object);
      meshes.push_back(object.placed);
    }
    std::sort(in_order.begin(), in_order.end(), [](const DerivedObject* a, const DerivedObject* b) {
      return a->placed.first_in_part < b->placed.first_in_part;
    });
    std::vector<Pieces> pieces;
    std::size_t copied = 0;
    const auto copy_to = [&](std::size_t end) {
      pieces.push_back(with_moved_vertices(text_.substr(0, end), model_.vertex_at, meshes, moved_, copied));
      copied = end;
    };
    bool has_parts = false;
    for (const DerivedObject* const object : in_order) {
      if (object->names_parts) {
        const std::size_t at = model_.objects[object->placed.object].at;
        copy_to(at);
        if (!std::exchange(has_parts, true)) pieces.push_back(in_sections(base_materials(at), {}));
        copy_to(for_each_attribute(text_, at, [](auto, auto) {}));
        pieces.push_back(in_sections(fmt::format(" pid=\"{}\" pindex=\"0\"", group_of_parts()), {}));
      }
      if (object->placed.vertices > 0) copy_to(element_end(text_, last_vertex_at(*object)));
      pieces.push_back(in_sections({}, {{object->added.size(), [this, object](std::string& to, std::size_t i) {
                                           append_vertex(to, *object, i);
                                         }}}));
      copy_to(triangle_at(*object, 0));
      pieces.push_back(triangles_of(*object));
      copied = element_end(text_, triangle_at(*object, object->placed.faces - 1));
    }
    copy_to(text_.size());
    return in_a_row(std::move(pieces));
  }

 private:
  std::size_t triangle_at(const DerivedObject& object, std::size_t t) const {
    return model_.triangle_at[object.placed.first_triangle + t];
  }
  std::size_t last_vertex_at(const DerivedObject& object) const {
    return model_.vertex_at[object.placed.first_in_part + object.placed.vertices - 1];
  }

  std::uint32_t group_of_parts() const { return model_.largest_id + 1; }
  /// A resource of the parts' names, in front of the object at a byte.
  std::string base_materials(std::size_t at) const {
    constexpr std::string_view kObject = "object";
    std::string_view prefix = tag_name(text_, at);
    prefix.remove_suffix(kObject.size());
    std::string made = fmt::format("<{}basematerials id=\"{}\">", prefix, group_of_parts());
    for (const ShellPart part : {ShellPart::Outer, ShellPart::Inner, ShellPart::Rim})
      made += fmt::format("<{}base name=\"{}\" displaycolor=\"#CCCCCC\"/>", prefix, name(part));
    return fmt::format("{}</{}basematerials>{}", made, prefix, space_before(text_, at));
  }

  void append_vertex(std::string& to, const DerivedObject& object, std::size_t i) const {
    const std::uint32_t v = object.added[i], own = derived_.origin(v).vertex[0];
    const Vec3d position = object.placed.transform.source_of(derived_.position(v));
    if (!position.isFinite())
      throw InvalidInput(moved_.source.path + ": expected transforms that lead back to finite numbers, got others");
    std::size_t like = last_vertex_at(object);
    to += space_before(text_, like);
    const bool is_of_object = is_own(object.placed, own), keeps_numbers = is_of_object && !derived_.new_position(v);
    if (is_of_object) like = model_.vertex_at[object.placed.first_in_part + own - object.placed.first_vertex];
    append_tag(to, text_, like, [&](std::string_view name, auto, std::string& value) {
      return !keeps_numbers && append_coordinate_named(value, name, position, moved_.precision);
    });
    to += "/>";
  }

  Pieces triangles_of(const DerivedObject& object) const {
    std::vector<Section> sections;
    for (const Run& run : object.runs) {
      sections.push_back({run.count, [this, &object, first = run.first](std::string& to, std::size_t t) {
                            append_in_place(to, object, first + t);
                          }});
      sections.push_back({run.others, [this, &object, first = run.first_other](std::string& to, std::size_t i) {
                            const Triangle& triangle = object.others[first + i];
                            const std::size_t parent = derived_.parent(triangle.face) - object.placed.first_face;
                            to += space_before(text_, triangle_at(object, parent));
                            append_triangle(to, object, triangle, parent);
                          }});
    }
    return in_sections({}, std::move(sections));
  }

  /// Appends what stands in the place of a triangle of the mesh, with what is in front of it and behind the one before.
  void append_in_place(std::string& to, const DerivedObject& object, std::size_t t) const {
    const std::size_t at = triangle_at(object, t), begin = t == 0 ? at : element_end(text_, triangle_at(object, t - 1));
    const std::uint32_t face = source_face(object.placed, t);
    if (derived_.is_kept(face)) {
      to += text_.substr(begin, element_end(text_, at) - begin);
      return;
    }
    const FaceRange pieces = derived_.pieces_of(face);
    for (std::uint32_t f = pieces.begin; f < pieces.end; ++f) {
      to += f == pieces.begin ? text_.substr(begin, at - begin) : space_before(text_, at);
      const auto corners = derived_.mesh().face(f);
      append_triangle(to, object, {{corners[0], corners[1], corners[2]}, f}, t);
    }
  }

  /// Appends a triangle that has the properties of another one, of the mesh.
  void append_triangle(std::string& to, const DerivedObject& object, const Triangle& triangle, std::size_t like) const {
    const std::size_t at = triangle_at(object, like);
    std::array<std::string_view, 3> known;
    std::string_view group;
    for_each_attribute(text_, at, [&](std::string_view name, std::string_view value) {
      if (name == "pid") group = value;
      if (name.size() == 2 && name[0] == 'p' && name[1] >= '1' && name[1] <= '3')
        known[static_cast<std::size_t>(name[1] - '1')] = value;
    });
    std::array<std::string_view, 3> property;
    (to += '<') += tag_name(text_, at);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangle.corners[object.placed.corner(k)];
      append_integer(to += fmt::format(" v{}=\"", k + 1), object.number_of(v));
      to += '"';
      const std::size_t of = object.placed.corner(corner_of_parent(triangle, v));
      property[k] = known[of].empty() ? known[0] : known[of];
    }
    if (object.names_parts) {
      to += fmt::format(" pid=\"{}\" p1=\"{}\"", group_of_parts(), static_cast<int>(derived_.part(triangle.face)));
    } else {
      if (!group.empty()) to += fmt::format(" pid=\"{}\"", group);
      const bool are_same = property[0] == property[1] && property[1] == property[2];
      for (std::size_t k = 0; k < (known[0].empty() ? 0u : are_same ? 1u : 3u); ++k)
        to += fmt::format(" p{}=\"{}\"", k + 1, property[k]);
    }
    to += "/>";
  }
  /// Which corner of the parent one of a triangle is nearest to.
  std::size_t corner_of_parent(const Triangle& triangle, std::uint32_t v) const {
    const auto face = derived_.mesh().face(triangle.face);
    CornerFinder finder(derived_.source_mesh());
    const CornerOrigin corner = derived_.corner(
        triangle.face, static_cast<std::size_t>(std::find(face.begin(), face.end(), v) - face.begin()), finder);
    const auto& share = corner.vertex.share;
    const auto nearest = static_cast<std::size_t>(std::max_element(share.begin(), share.end()) - share.begin());
    return corner.corner[nearest] - derived_.source_mesh().face_begin[derived_.parent(triangle.face)];
  }

  std::string_view text_;
  const ThreeMfModel& model_;
  const DerivedMesh& derived_;
  const MovedMesh& moved_;
};

}  // namespace

std::size_t DerivedObject::number_of(std::uint32_t v) const {
  if (is_own(placed, v)) return v - placed.first_vertex;
  return placed.vertices + static_cast<std::size_t>(std::lower_bound(added.begin(), added.end(), v) - added.begin());
}

std::vector<DerivedObject> split_by_objects(const DerivedMesh& derived, const std::vector<PlacedMesh>& meshes) {
  std::vector<DerivedObject> objects;
  objects.reserve(meshes.size());
  for (const PlacedMesh& mesh : meshes) objects.push_back({mesh, {}, {}, {}});
  const auto object_of = [&](std::uint32_t face) -> DerivedObject& {
    return *std::prev(std::upper_bound(objects.begin(), objects.end(), derived.parent(face),
                                       [](std::size_t f, const DerivedObject& o) { return f < o.placed.first_face; }));
  };
  const auto add_vertices = [](DerivedObject& object, std::span<const std::uint32_t> corners) {
    for (const std::uint32_t v : corners)
      if (!is_own(object.placed, v)) object.added.push_back(v);
  };
  const FaceRange others = derived.other_faces();
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t f = 0; f < derived.face_count(); ++f) {
    DerivedObject& object = object_of(f);
    add_vertices(object, derived.mesh().face(f));
    if (f < others.begin) continue;
    triangles.clear();
    append_triangles(derived.mesh(), f, triangles);
    for (const auto& [a, b, c] : triangles)  // the format forbids triangles that have a vertex twice
      if (a != b && b != c && c != a) object.others.push_back({{a, b, c}, f});
  }
  std::erase_if(objects, [&](const DerivedObject& object) {
    const std::uint32_t first = source_face(object.placed, 0), end = source_face(object.placed, object.placed.faces);
    for (std::uint32_t f = first; f < end; ++f)
      if (derived.pieces_of(f).size() > 0) return false;
    return true;
  });
  for (DerivedObject& object : objects) {
    std::sort(object.added.begin(), object.added.end());
    object.added.erase(std::unique(object.added.begin(), object.added.end()), object.added.end());
  }
  return objects;
}

void order_triangles(const DerivedMesh& derived, const ThreeMfModel& model, DerivedObject& object,
                     const std::vector<SlicerNames::Volume>* volumes) {
  const auto property = model.properties.begin() + static_cast<std::ptrdiff_t>(object.placed.first_triangle);
  object.names_parts = derived.is_shell() && model.largest_id < kNone / 2 &&
                       model.objects[object.placed.object].property == 0 &&
                       std::all_of(property, property + static_cast<std::ptrdiff_t>(object.placed.faces),
                                   [](const ThreeMfProperty& each) { return each.group == 0; });
  std::vector<std::size_t> begins{0};
  for (std::size_t i = 0; volumes && i < volumes->size(); ++i)
    for (const std::size_t begin : {(*volumes)[i].first, (*volumes)[i].last + 1})
      if (begin < object.placed.faces) begins.push_back(begin);
  std::sort(begins.begin(), begins.end());
  begins.erase(std::unique(begins.begin(), begins.end()), begins.end());
  const auto run_of = [&](const Triangle& triangle) {
    const std::size_t parent = derived.parent(triangle.face) - object.placed.first_face;
    return std::upper_bound(begins.begin(), begins.end(), parent);
  };
  std::stable_sort(object.others.begin(), object.others.end(),
                   [&](const Triangle& a, const Triangle& b) { return run_of(a) < run_of(b); });
  std::size_t number = 0, other = 0;
  for (auto begin = begins.begin(); begin != begins.end(); ++begin) {
    const std::size_t end = begin + 1 == begins.end() ? object.placed.faces : *(begin + 1);
    Run run{*begin, end - *begin, other, 0, number, 0};
    for (; other < object.others.size() && run_of(object.others[other]) == begin + 1; ++other) ++run.others;
    run.numbers = run.others;
    for (std::size_t t = run.first; t < end; ++t) {
      const std::size_t pieces = derived.pieces_of(source_face(object.placed, t)).size();
      run.numbers += pieces;
      object.keeps_numbers = object.keeps_numbers && pieces == 1;
    }
    object.keeps_numbers = object.keeps_numbers && run.first == run.number;
    number += run.numbers;
    object.runs.push_back(run);
  }
}

Pieces derived_part(std::string_view text, const ThreeMfModel& model, const DerivedMesh& derived,
                    const std::vector<DerivedObject>& objects, const MovedMesh& moved) {
  const auto made = std::make_shared<const PartText>(text, model, derived, moved);
  const Pieces pieces = made->run(objects);
  return {pieces.count, [made, pieces](std::size_t i) { return pieces.make(i); }};
}

std::string with_volumes(std::string_view settings, const SlicerNames& names, const ThreeMfModel& model,
                         const std::vector<DerivedObject>& objects) {
  struct Change {
    const SlicerNames::Volume* volume;
    std::size_t first, end;
  };
  std::vector<Change> changes;
  for (const DerivedObject& object : objects) {
    const auto volumes = names.volumes.find(model.objects[object.placed.object].id);
    if (volumes == names.volumes.end()) continue;
    for (const SlicerNames::Volume& volume : volumes->second) {
      Change change{&volume, 0, 0};
      for (const Run& run : object.runs) {
        if (run.first == volume.first) change.first = run.number;
        if (run.first <= volume.last) change.end = run.number + run.numbers;
      }
      if (volume.last < object.placed.faces) changes.push_back(change);
    }
  }
  std::sort(changes.begin(), changes.end(),
            [](const Change& a, const Change& b) { return a.volume->at < b.volume->at; });
  std::string made;
  std::size_t copied = 0;
  for (const Change& change : changes) {
    const std::size_t at = change.volume->at;
    made += settings.substr(copied, at - copied);
    if (change.first >= change.end) {
      copied = element_end(settings, at);
      continue;
    }
    copied = append_tag(made, settings, at, [&](std::string_view name, auto, std::string& value) {
      if (name == "firstid") append_integer(value, change.first);
      if (name == "lastid") append_integer(value, change.end - 1);
      return name == "firstid" || name == "lastid";
    });
  }
  return made += settings.substr(copied);
}

}  // namespace vdb_offset::io
