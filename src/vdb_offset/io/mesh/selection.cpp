// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>

#include "vdb_offset/error.h"
#include "vdb_offset/io/base/nearest_names.h"
#include "vdb_offset/io/base/scanner.h"
#include "vdb_offset/io/mesh/face_labels.h"

namespace vdb_offset::io {
namespace {

struct SelectorWord {
  const char* word;
  Selector::By by;
};
constexpr SelectorWord kSelectorWords[] = {{"group", Selector::By::Group}, {"material", Selector::By::Material},
                                           {"faces", Selector::By::File},  {"face", Selector::By::Face},
                                           {"name", Selector::By::Name},   {"color", Selector::By::Colour}};

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

class Chooser {
 public:
  Chooser(std::span<const Selector> selectors, std::size_t faces) : selectors_(selectors) {
    labels_.chosen.reserve(faces);
  }

  void set_groups(std::vector<std::string> names) { groups_ = std::move(names), settle(); }
  void set_object(std::string name) { object_ = std::move(name), settle(); }
  void set_material(std::string name) { material_ = std::move(name), settle(); }
  void add_face() {
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
  visit_labels(mesh, chooser);
  return chooser.take();
}

void require_known(const MeshFile& mesh, const Labels& labels, const Selector& selector) {
  const bool group = selector.by == Selector::By::Group;
  const auto& known = group ? labels.groups : labels.materials;
  if (known.contains(selector.name)) return;
  const char* const kind = group ? "group" : "material";
  throw InvalidOption(
      known.empty() ? fmt::format("{}: expected a {} '{}', got a file without any", mesh.path, kind, selector.name)
                    : fmt::format("{}: expected a {} among {}, got '{}'", mesh.path, kind,
                                  nearest_names(selector.name, {known.begin(), known.end()}), selector.name));
}

/// Marks the faces that a file lists, either by a 0 or 1 for each face or by their indices.
void mark_from_file(const std::string& path, std::vector<std::uint8_t>& marks) {
  FileBytes bytes = FileBytes::open(path);
  Scanner scanner(path, bytes.view(), byte_order_mark(bytes.view()), false, '#');
  // The numbers are read both ways, as only the length of the list, at the end of the file, tells which one is meant.
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

}  // namespace

Selector parse_selector(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string kind = text.substr(0, equals), name = equals == std::string::npos ? "" : text.substr(equals + 1);
  if (!name.empty())
    for (const auto& [word, by] : kSelectorWords)
      if (kind == word) return {by, name};
  throw InvalidOption(
      fmt::format("expected 'group=NAME', 'material=NAME', 'faces=FILE', or of a CAD model 'face=N', 'name=NAME' or "
                  "'color=RRGGBB', got '{}'",
                  text));
}

const char* in_words(Selector::By by) {
  return std::find_if(std::begin(kSelectorWords), std::end(kSelectorWords),
                      [&](const SelectorWord& each) { return each.by == by; })
      ->word;
}

std::vector<std::uint8_t> select_faces(const MeshFile& mesh, std::span<const Selector> selectors) {
  const bool by_label = std::any_of(selectors.begin(), selectors.end(), is_label);
  Labels labels;
  if (by_label) labels = label(mesh, selectors);
  labels.chosen.resize(mesh.polygons.face_count(), 0);
  for (const Selector& selector : selectors) {
    if (selector.by == Selector::By::File) mark_from_file(selector.name, labels.chosen);
    else if (is_label(selector)) require_known(mesh, labels, selector);
    else if (!mesh.document)
      throw InvalidOption(fmt::format("{}: expected a CAD model for '{}={}', got another file", mesh.path,
                                      in_words(selector.by), selector.name));
    else join(labels.chosen, mesh.document->select(mesh, selector));
  }
  return std::move(labels.chosen);
}

}  // namespace vdb_offset::io
