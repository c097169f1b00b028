// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/mesh_file.h"

#include <fmt/format.h>

#include <unordered_map>

#include "document/document.h"

namespace vdb_offset::io {
namespace {

/// The faces of each group, or of each object or material.
class NamedWalls {
 public:
  void set(std::string name) { name_ = std::move(name), current_ = kUnknown; }
  void add_face() {
    if (current_ == kUnknown) {
      const auto [known, added] = index_.try_emplace(name_, static_cast<std::uint32_t>(walls_.names.size()));
      if (added) walls_.names.push_back(name_.empty() ? "wall" : name_);
      current_ = known->second;
      any_ = any_ || !name_.empty();
    }
    walls_.of_face.push_back(current_);
  }
  bool any() const { return any_; }
  WallNames take() { return std::move(walls_); }

 private:
  static constexpr std::uint32_t kUnknown = 0xffffffff;

  WallNames walls_;
  std::unordered_map<std::string, std::uint32_t> index_;
  std::string name_;
  std::uint32_t current_ = kUnknown;
  bool any_ = false;
};

struct Collector final : LabelListener {
  NamedWalls groups, materials, objects;

  void set_groups(std::vector<std::string> names) override { groups.set(fmt::format("{}", fmt::join(names, "_"))); }
  void set_object(std::string name) override { objects.set(std::move(name)); }
  void set_material(std::string name) override { materials.set(std::move(name)); }
  void add_face() override {
    for (NamedWalls* kind : {&groups, &materials, &objects}) kind->add_face();
  }
};

}  // namespace

WallNames wall_names(const MeshFile& mesh) {
  Collector collector;
  mesh.document->visit_labels(mesh, collector);
  for (NamedWalls* kind : {&collector.groups, &collector.materials, &collector.objects})
    if (kind->any()) return kind->take();
  return {};
}

}  // namespace vdb_offset::io
