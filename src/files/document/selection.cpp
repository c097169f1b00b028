// SPDX-License-Identifier: Apache-2.0
// Marks the faces that selectors name: by group, material, a file of numbers, face, name or colour of a CAD model, or
// by shape. Names of groups and materials are collected in one pass over the labels of the file. A file of numbers is
// read as marks and as indices at once, as only its length decides which it is. Shapes are found by face_shapes.cpp,
// and what a CAD model knows by its document. The marks of all selectors are joined, and faces behind not: are taken
// out of them, or of all faces if nothing else is named. A name that no face has is refused with those that are like
// it, and so are a shape that is not there and a selection that leaves nothing. What becomes of marked faces is decided
// elsewhere.
#include "vdb_offset/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "bytes/nearest_names.h"
#include "bytes/scanner.h"
#include "document/document.h"
#include "document/face_shapes.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

struct SelectorWord {
  const char* word;
  Selector::By by;
};
constexpr SelectorWord kSelectorWords[] = {{"group", Selector::By::Group}, {"material", Selector::By::Material},
                                           {"faces", Selector::By::File},  {"face", Selector::By::Face},
                                           {"name", Selector::By::Name},   {"color", Selector::By::Colour}};
constexpr SelectorWord kShapeWords[] = {{"holes", Selector::By::Holes},   {"concave", Selector::By::Concave},
                                        {"convex", Selector::By::Convex}, {"up", Selector::By::Up},
                                        {"down", Selector::By::Down},     {"planar", Selector::By::Planar}};

bool is_shape(const Selector& selector) {
  return std::any_of(std::begin(kShapeWords), std::end(kShapeWords),
                     [&](const SelectorWord& each) { return each.by == selector.by; });
}

bool is_label(const Selector& selector) {
  return selector.by == Selector::By::Group || selector.by == Selector::By::Material;
}

void join(std::vector<std::uint8_t>& marks, const std::vector<std::uint8_t>& others) {
  std::transform(marks.begin(), marks.end(), others.begin(), marks.begin(),
                 [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a | b); });
}

/// The names of groups and materials of a file, and the faces that selectors choose by them.
struct Labels {
  std::set<std::string, std::less<>> groups, materials;  // names with at least one face
  std::vector<std::uint8_t> chosen;                      // of each face: 1 if a selector chooses it
};

class Chooser final : public LabelListener {
 public:
  Chooser(std::span<const Selector> selectors, std::size_t faces) : selectors_(selectors) {
    labels_.chosen.reserve(faces);
  }

  void set_groups(std::vector<std::string> names) override { groups_ = std::move(names), settle(); }
  void set_object(std::string name) override { object_ = std::move(name), settle(); }
  void set_material(std::string name) override { material_ = std::move(name), settle(); }
  void add_face() override {
    if (!counted_) count_names();
    labels_.chosen.push_back(chosen_);
  }
  Labels take() { return std::move(labels_); }

 private:
  bool names(const Selector& selector) const {
    if (selector.by == Selector::By::Material) return selector.name == material_;
    return selector.by == Selector::By::Group &&
           (selector.name == object_ || std::find(groups_.begin(), groups_.end(), selector.name) != groups_.end());
  }
  void settle() {
    chosen_ = std::any_of(selectors_.begin(), selectors_.end(), [&](const Selector& s) { return names(s); });
    counted_ = false;
  }
  void count_names() {
    counted_ = true;
    for (const std::string& group : groups_) labels_.groups.insert(group);
    if (!object_.empty()) labels_.groups.insert(object_);
    if (!material_.empty()) labels_.materials.insert(material_);
  }

  std::span<const Selector> selectors_;
  Labels labels_;
  std::vector<std::string> groups_;
  std::string object_, material_;
  bool chosen_ = false, counted_ = false;
};

Labels label(const MeshFile& mesh, std::span<const Selector> selectors) {
  Chooser chooser(selectors, mesh.polygons.face_count());
  mesh.document->visit_labels(mesh, chooser);
  return chooser.take();
}

void require_known(const MeshFile& mesh, const Labels& labels, const Selector& selector) {
  const bool group = selector.by == Selector::By::Group;
  const auto& known = group ? labels.groups : labels.materials;
  if (known.contains(selector.name)) return;
  const char* const kind = group ? "group" : "material";
  throw InvalidOption(known.empty()
                          ? fmt::format("{} has no {}s: '{}'", mesh.path, kind, selector.name)
                          : fmt::format("{}: expected a {} among {}, got '{}'", mesh.path, kind,
                                        nearest_names(selector.name, {known.begin(), known.end()}), selector.name));
}

/// Marks the faces that a file lists, either by a 0 or 1 for each face or by their indices.
void mark_from_file(const std::string& path, std::vector<std::uint8_t>& marks) {
  FileBytes bytes = FileBytes::open(path);
  Scanner scanner(path, bytes.view(), byte_order_mark(bytes.view()), false, '#');
  // The numbers are read both ways, as only the length of the list, at the end of the file, shows which one is meant.
  std::vector<std::uint8_t> as_marks, as_indices(marks.size(), 0);
  as_marks.reserve(marks.size());
  bool may_be_marks = true;
  while (!scanner.at_text_end()) {
    const std::int64_t number = scanner.integer_anywhere("the index of a face, or a mark of 0 or 1");
    if (number < 0 || number >= static_cast<std::int64_t>(marks.size()))
      scanner.fail(fmt::format("the index of a face, from 0 to {}", marks.size() - 1), scanner.last_token());
    may_be_marks = may_be_marks && number <= 1 && as_marks.size() < marks.size();
    if (may_be_marks) as_marks.push_back(static_cast<std::uint8_t>(number));
    as_indices[static_cast<std::size_t>(number)] = 1;
  }
  const bool is_mask = may_be_marks && as_marks.size() == marks.size();
  join(marks, is_mask ? as_marks : as_indices);
}

/// Whether a hole has a diameter that a selector asks for.
bool has_diameter(const RoundHole& hole, const Selector& selector) {
  return (!selector.narrower_than || hole.diameter < *selector.narrower_than) &&
         (!selector.wider_than || hole.diameter > *selector.wider_than);
}

[[noreturn]] void fail_without_hole(const MeshFile& mesh, const std::vector<RoundHole>& holes,
                                    const Selector& selector) {
  if (holes.empty())
    throw InvalidOption(fmt::format(
        "{}: expected round holes for 'holes' (closed cylinders or cones of eight flat faces and more), found none",
        mesh.path));
  const auto narrowest = std::min_element(
      holes.begin(), holes.end(), [](const RoundHole& a, const RoundHole& b) { return a.diameter < b.diameter; });
  const auto widest = std::max_element(holes.begin(), holes.end(),
                                       [](const RoundHole& a, const RoundHole& b) { return a.diameter < b.diameter; });
  throw InvalidOption(fmt::format("{}: expected holes of a diameter {} {:.6g}, found {} from {:.6g} to {:.6g}",
                                  mesh.path, selector.narrower_than ? "below" : "above",
                                  selector.narrower_than ? *selector.narrower_than : *selector.wider_than, holes.size(),
                                  narrowest->diameter, widest->diameter));
}

/// Marks the faces of a shape.
std::vector<std::uint8_t> marks_of_shape(const MeshFile& mesh, const FaceShapes& shapes, const Selector& selector) {
  std::vector<std::uint8_t> marks(mesh.polygons.face_count(), 0);
  if (selector.by == Selector::By::Holes) {
    const std::vector<RoundHole> holes = shapes.holes();
    for (const RoundHole& hole : holes)
      if (has_diameter(hole, selector))
        for (const auto f : hole.faces) marks[f] = 1;
    if (std::find(marks.begin(), marks.end(), 1) == marks.end()) fail_without_hole(mesh, holes, selector);
    return marks;
  }
  const bool up = selector.by == Selector::By::Up, convex = selector.by == Selector::By::Convex;
  if (selector.by == Selector::By::Planar)
    marks = shapes.flat_end(static_cast<std::size_t>(selector.name[1] - 'x'), selector.name[0] == '+' ? 1 : -1);
  else if (up || selector.by == Selector::By::Down) marks = shapes.facing(up ? 1 : -1);
  else marks = shapes.curved(convex ? 1 : -1);
  if (std::find(marks.begin(), marks.end(), 1) == marks.end())
    throw InvalidOption(fmt::format("{}: expected faces that are '{}{}{}', found none", mesh.path,
                                    in_words(selector.by), selector.name.empty() ? "" : ":", selector.name));
  return marks;
}

/// Marks the faces that any of some selectors names, as if none was negated.
std::vector<std::uint8_t> marks_of(const MeshFile& mesh, std::span<const Selector> selectors) {
  const bool by_label = std::any_of(selectors.begin(), selectors.end(), is_label);
  Labels labels;
  if (by_label) labels = label(mesh, selectors);
  labels.chosen.resize(mesh.polygons.face_count(), 0);
  std::optional<FaceShapes> shapes;
  for (const Selector& selector : selectors) {
    if (is_shape(selector)) {
      if (!shapes) shapes.emplace(mesh.polygons.view());
      join(labels.chosen, marks_of_shape(mesh, *shapes, selector));
    } else if (selector.by == Selector::By::File) {
      mark_from_file(selector.name, labels.chosen);
    } else if (is_label(selector)) {
      require_known(mesh, labels, selector);
    } else {
      const auto chosen = mesh.document->select(mesh, selector);
      if (!chosen)
        throw InvalidOption(fmt::format("{}: expected a CAD model for '{}={}', got another file", mesh.path,
                                        in_words(selector.by), selector.name));
      join(labels.chosen, *chosen);
    }
  }
  return std::move(labels.chosen);
}

std::optional<double> parse_diameter(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !(number > 0) || !std::isfinite(number))
    return std::nullopt;
  return number;
}

/// \throw InvalidOption for an end of no axis
std::optional<Selector> parse_end(const std::string& text) {
  const std::string planar = in_words(Selector::By::Planar);
  if (text != planar && !text.starts_with(planar + ':')) return std::nullopt;
  const std::string end = text.substr(std::min(text.size(), planar.size() + 1));
  if (end.size() != 2 || (end[0] != '+' && end[0] != '-') || end[1] < 'x' || end[1] > 'z')
    throw InvalidOption(fmt::format("expected an end along an axis, as in 'planar:+z' or 'planar:-x', got '{}'", text));
  return Selector{Selector::By::Planar, end};
}

std::optional<Selector> parse_shape(const std::string& text) {
  if (std::optional<Selector> end = parse_end(text)) return end;
  for (const auto& [word, by] : kShapeWords)
    if (text == word) return Selector{by, {}};
  const std::string holes = in_words(Selector::By::Holes);
  const bool narrower = text.starts_with(holes + '<'), wider = text.starts_with(holes + '>');
  if (!narrower && !wider) return std::nullopt;
  const std::optional<double> diameter = parse_diameter(text.substr(holes.size() + 1));
  if (!diameter)
    throw InvalidOption(
        fmt::format("expected a diameter above 0, in the file's units, as in 'holes<8', got '{}'", text));
  Selector selector{Selector::By::Holes, {}};
  (narrower ? selector.narrower_than : selector.wider_than) = diameter;
  return selector;
}

}  // namespace

Selector parse_selector(const std::string& text) {
  constexpr std::string_view kNot = "not:";
  if (text.starts_with(kNot) && !text.substr(kNot.size()).starts_with(kNot)) {
    Selector selector = parse_selector(text.substr(kNot.size()));
    selector.is_negated = true;
    return selector;
  }
  if (const std::optional<Selector> shape = parse_shape(text)) return *shape;
  const std::size_t equals = text.find('=');
  const std::string kind = text.substr(0, equals), name = equals == std::string::npos ? "" : text.substr(equals + 1);
  if (!name.empty())
    for (const auto& [word, by] : kSelectorWords)
      if (kind == word) return {by, name};
  throw InvalidOption(
      fmt::format("expected 'group=NAME', 'material=NAME', 'faces=FILE', 'holes', 'holes<D', 'holes>D', 'concave', "
                  "'convex', 'up', 'down', 'planar:+z', or of a CAD model 'face=N', 'name=NAME' or 'color=RRGGBB', or "
                  "'not:' and one "
                  "of these, got '{}'",
                  text));
}

const char* in_words(Selector::By by) {
  for (const auto& words : {std::span<const SelectorWord>(kSelectorWords), std::span<const SelectorWord>(kShapeWords)})
    for (const SelectorWord& each : words)
      if (each.by == by) return each.word;
  return "";
}

std::vector<std::uint8_t> select_faces(const MeshFile& mesh, std::span<const Selector> selectors) {
  std::vector<Selector> named, negated;
  for (const Selector& selector : selectors) (selector.is_negated ? negated : named).push_back(selector);
  if (negated.empty()) return marks_of(mesh, named);
  std::vector<std::uint8_t> chosen(mesh.polygons.face_count(), 1);
  if (!named.empty()) chosen = marks_of(mesh, named);
  const std::vector<std::uint8_t> left_out = marks_of(mesh, negated);
  for (std::size_t f = 0; f < chosen.size(); ++f)
    if (left_out[f]) chosen[f] = 0;
  if (std::find(chosen.begin(), chosen.end(), 1) == chosen.end())
    throw InvalidOption(mesh.path + ": no faces are left, as 'not:' leaves all of them out");
  return chosen;
}

}  // namespace vdb_offset::io
