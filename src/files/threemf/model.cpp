// SPDX-License-Identifier: Apache-2.0
// Reads model parts: 3MF core specification 1.3, materials 1.2, production 1.1.
#include "threemf/model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "bytes/scanner.h"
#include "ground/system/memory.h"
#include "threemf/xml_elements.h"

namespace vdb_offset::io {
namespace {

struct Unit {
  std::string_view name;
  double micrometres;
};
constexpr Unit kUnits[] = {{"micron", 1},   {"millimeter", 1e3}, {"centimeter", 1e4},
                           {"inch", 25400}, {"foot", 304800},    {"meter", 1e6}};
constexpr std::string_view kProductionPath = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06|path",
                           kSliceResolution =
                               "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07|meshresolution";
constexpr std::uint32_t kMostId = 0x7fffffff;  // of resources and their indices (core specification, ST_ResourceID)

/// What an element is, by its name and where it stands.
enum class Context : std::uint8_t {
  Document,
  Model,
  Resources,
  Object,
  Mesh,
  Vertices,
  Triangles,
  Components,
  Build,
  Bases,
  Colours,
  Ignored
};

std::string_view in_core(std::string_view name) {
  const bool is_core =
      name.size() > kThreeMfCore.size() && name[kThreeMfCore.size()] == '|' && name.starts_with(kThreeMfCore);
  return is_core ? name.substr(kThreeMfCore.size() + 1) : std::string_view();
}

std::string_view local_name(std::string_view name) { return name.substr(name.rfind('|') + 1); }

/// Without the blanks around it.
std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

class ModelReader : public XmlElements {
 public:
  ModelReader(const std::string& label, std::string_view text, bool with_properties, bool unit_alone)
      : XmlElements(label, text), with_properties_(with_properties), unit_alone_(unit_alone) {}

  ThreeMfModel take() { return std::move(model_); }

 private:
  void begin(std::string_view name, const XmlAttributes& attributes) override {
    const Context outer = open_.empty() ? Context::Document : open_.back();
    open_.push_back(enter(outer, name, attributes));
  }
  void end() override { open_.pop_back(); }

  Context enter(Context outer, std::string_view name, const XmlAttributes& attributes) {
    const std::string_view core = in_core(name);
    switch (outer) {
      case Context::Vertices:
        if (core == "vertex") add_vertex(attributes);
        break;
      case Context::Triangles:
        if (core == "triangle") add_triangle(attributes);
        break;
      case Context::Document:
        return enter_model(name, attributes);
      case Context::Model:
        if (core == "resources") return Context::Resources;
        if (core == "build") return Context::Build;
        if (core == "metadata") model_.extras.insert("metadata");
        break;
      case Context::Resources:
        return enter_resource(name, attributes);
      case Context::Object:
        return enter_geometry(name);
      case Context::Mesh:
        if (core == "vertices") return Context::Vertices;
        if (core == "triangles") return Context::Triangles;
        model_.extras.insert(fmt::format("elements '{}' of meshes", in_short(local_name(name))));
        break;
      case Context::Components:
        if (core == "component") object().components.push_back(placement(attributes));
        break;
      case Context::Build:
        if (core == "item") model_.items.push_back(placement(attributes));
        break;
      case Context::Bases:
        if (core == "base") model_.materials[group_].emplace_back(required(attributes, "name"));
        break;
      case Context::Colours:
        if (local_name(name) == "color") model_.colours[group_].push_back(colour(required(attributes, "color")));
        break;
      case Context::Ignored:
        break;
    }
    return Context::Ignored;
  }

  Context enter_model(std::string_view name, const XmlAttributes& attributes) {
    if (in_core(name) != "model")
      fail(fmt::format("an element 'model' of {}", kThreeMfCore), fmt::format("'{}'", in_short(name, 80)));
    if (const char* const unit = attributes.find("unit")) model_.unit_micrometres = unit_named(unit);
    if (unit_alone_) stop();
    return Context::Model;
  }

  double unit_named(std::string_view name) const {
    for (const Unit& unit : kUnits)
      if (unit.name == name) return unit.micrometres;
    fail("a unit micron, millimeter, centimeter, inch, foot or meter", fmt::format("'{}'", in_short(name)));
  }

  Context enter_resource(std::string_view name, const XmlAttributes& attributes) {
    const std::string_view core = in_core(name);
    if (std::int64_t id = 0; attributes.find("id") && parse_integer(attributes.find("id"), id) && id <= kMostId)
      model_.largest_id = std::max(model_.largest_id, static_cast<std::uint32_t>(std::max<std::int64_t>(id, 0)));
    if (core == "object") {
      add_object(attributes);
      return Context::Object;
    }
    if (core == "basematerials") {
      group_ = integer(required(attributes, "id"), "a resource's id");
      return Context::Bases;
    }
    if (name.starts_with(kThreeMfMaterial) && local_name(name) == "colorgroup") {
      group_ = integer(required(attributes, "id"), "a resource's id");
      return Context::Colours;
    }
    model_.extras.insert(fmt::format("resources '{}'", in_short(local_name(name))));
    return Context::Ignored;
  }

  void add_object(const XmlAttributes& attributes) {
    objects_.add();
    ThreeMfObject added;
    added.at = here();
    added.id = integer(required(attributes, "id"), "a resource's id");
    if (const char* const name = attributes.find("name")) added.name = name;
    if (const char* const type = attributes.find("type")) added.type = type;
    if (const char* const group = attributes.find("pid")) added.property = integer(group, "a resource's id");
    if (const char* const index = attributes.find("pindex")) added.property_index = integer(index, "an index");
    if (const char* const mesh = attributes.find(kSliceResolution))
      added.has_exact_slices = std::string_view(mesh) == "lowres";
    if (!model_.by_id.emplace(added.id, model_.objects.size()).second)
      fail("an id that no object before has", fmt::format("{}", added.id));
    model_.objects.push_back(std::move(added));
  }

  Context enter_geometry(std::string_view name) {
    const std::string_view core = in_core(name);
    if (core == "mesh") {
      if (object().is_mesh) fail("one mesh in an object", "two");
      object().is_mesh = true;
      object().first_vertex = model_.positions.size();
      object().first_triangle = model_.triangles.size();
      return Context::Mesh;
    }
    if (core == "components") return Context::Components;
    if (core == "metadatagroup") model_.extras.insert("metadata");
    else object().other = local_name(name);
    return Context::Ignored;
  }

  void add_vertex(const XmlAttributes& attributes) {
    std::array<const char*, 3> text{};
    for (const char** pair = attributes.pairs(); *pair; pair += 2)
      if (const char* const name = *pair; name[0] >= 'x' && name[0] <= 'z' && name[1] == 0)
        text[name[0] - 'x'] = pair[1];
    Vec3d position;
    for (int k = 0; k < 3; ++k) {
      if (!text[k]) fail(fmt::format("a coordinate '{}' of a vertex", "xyz"[k]), "none");
      position[k] = number(text[k], "a coordinate");
    }
    held_.add();
    model_.positions.push_back(position);
    model_.vertex_at.push_back(here());
    ++object().vertices;
  }

  void add_triangle(const XmlAttributes& attributes) {
    std::array<const char*, 3> corner{}, index{};
    const char* group = nullptr;
    for (const char** pair = attributes.pairs(); *pair; pair += 2) {
      const std::string_view name = *pair;
      if (name == "pid") group = pair[1];
      if (name.size() != 2 || name[1] < '1' || name[1] > '3') continue;
      if (name[0] == 'v') corner[name[1] - '1'] = pair[1];
      if (name[0] == 'p') index[name[1] - '1'] = pair[1];
    }
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!corner[k]) fail(fmt::format("a corner 'v{}' of a triangle", k + 1), "none");
      triangle[k] = integer(corner[k], "the index of a vertex");
      if (triangle[k] >= object().vertices)
        fail(fmt::format("the index of one of {} vertices", object().vertices), fmt::format("{}", triangle[k]));
    }
    held_.add();
    model_.triangles.push_back(triangle);
    ++object().triangles;
    if (!with_properties_) return;
    model_.triangle_at.push_back(here());
    add_property(group, index);
  }

  void add_property(const char* group, const std::array<const char*, 3>& index) {
    ThreeMfProperty property{object().property, {}};
    property.index.fill(object().property_index);
    if (group) property.group = integer(group, "a resource's id");
    if (index[0]) property.index.fill(integer(index[0], "an index"));
    for (std::size_t k = 1; k < 3; ++k)
      if (index[0] && index[k]) property.index[k] = integer(index[k], "an index");
    if (group && !index[0]) property.group = 0;  // names a group and nothing of it
    model_.properties.push_back(property);
  }

  ThreeMfPlacement placement(const XmlAttributes& attributes) {
    placed_.add();
    ThreeMfPlacement placed;
    placed.at = here();
    placed.object = integer(required(attributes, "objectid"), "a resource's id");
    if (const char* const part = attributes.find(kProductionPath)) placed.part = part;
    if (const char* const text = attributes.find("transform")) placed.transform = transform(text);
    return placed;
  }

  ThreeMfTransform transform(std::string_view text) const {
    const char* const expected = "a transform of 12 numbers";
    ThreeMfTransform made;
    std::string_view rest = text;
    for (std::size_t k = 0; k < 12; ++k) {
      rest = trimmed(rest);
      const std::string_view word = rest.substr(0, rest.find(' '));
      if (word.empty()) fail(expected, fmt::format("{}", k));
      made.row[k / 3][static_cast<int>(k % 3)] = number(word, expected);
      rest.remove_prefix(word.size());
    }
    if (!trimmed(rest).empty()) fail(expected, "more");
    if (!made.is_regular()) fail("a transform that keeps space as it is", fmt::format("'{}'", in_short(text, 80)));
    return made;
  }

  double number(std::string_view text, const char* expected) const {
    double value = 0;
    if (!parse_double(trimmed(text), value) || !std::isfinite(value))
      fail(std::string(expected) + " that is a finite number", fmt::format("'{}'", in_short(text)));
    return value;
  }

  std::uint32_t integer(std::string_view text, const char* expected) const {
    std::int64_t value = 0;
    if (!parse_integer(trimmed(text), value) || value < 0 || value > kMostId)
      fail(fmt::format("{}, from 0 to {}", expected, kMostId), fmt::format("'{}'", in_short(text)));
    return static_cast<std::uint32_t>(value);
  }

  /// #RRGGBB or #RRGGBBAA.
  std::array<double, 4> colour(std::string_view text) const {
    std::array<double, 4> made{0, 0, 0, 1};
    const bool fits = (text.size() == 7 || text.size() == 9) && text[0] == '#' &&
                      text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
    if (!fits) fail("a colour #RRGGBB or #RRGGBBAA", fmt::format("'{}'", in_short(text)));
    for (std::size_t k = 0; 2 * k + 1 < text.size(); ++k)
      made[k] = std::stoi(std::string(text.substr(2 * k + 1, 2)), nullptr, 16) / 255.0;
    return made;
  }

  ThreeMfObject& object() { return model_.objects.back(); }

  ThreeMfModel model_;
  bool with_properties_, unit_alone_;
  std::vector<Context> open_;
  std::uint32_t group_ = 0;
  // A triangle takes three numbers, its property four, and its place two; a vertex less.
  MemoryWatch held_{label(), sizeof(Vec3d) + 2 * sizeof(std::uint64_t)}, placed_{label(), sizeof(ThreeMfPlacement)},
      objects_{label(), sizeof(ThreeMfObject)};
};

class RelationReader : public XmlElements {
 public:
  using XmlElements::XmlElements;

  std::string target;

 private:
  void begin(std::string_view name, const XmlAttributes& attributes) override {
    const char *const type = attributes.find("Type"), *const to = attributes.find("Target");
    if (local_name(name) != "Relationship" || !type || !to || !target.empty()) return;
    if (std::string_view(type) == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel") target = to;
  }
};

}  // namespace

ThreeMfModel read_model(const std::string& label, std::string_view text, bool with_properties) {
  ModelReader reader(label, text, with_properties, false);
  reader.run();
  return reader.take();
}

double unit_of_model(const std::string& label, std::string_view text) {
  ModelReader reader(label, text, false, true);
  reader.run();
  return reader.take().unit_micrometres;
}

std::string_view name_of_unit(double micrometres) {
  for (const Unit& unit : kUnits)
    if (unit.micrometres == micrometres) return unit.name;
  return {};
}

std::string model_part(const std::string& label, std::string_view relations) {
  RelationReader reader(label, relations);
  reader.run();
  return reader.target;
}

}  // namespace vdb_offset::io
