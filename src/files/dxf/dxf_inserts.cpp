// SPDX-License-Identifier: Apache-2.0
// Finds what of a DXF file is drawn where: what is hidden, and what INSERT shows.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "bytes/scanner.h"
#include "dxf/dxf.h"
#include "ground/system/memory.h"

namespace vdb_offset::io {
namespace {

/// Whether an entity is seen, and why not.
enum class Sight : std::uint8_t { Shown, LayerOff, Hidden, OtherSpace };

class InsertResolver {
 public:
  InsertResolver(const DxfText& text, DxfDocument document) : text_(text) { drawing_.document = std::move(document); }

  /// Takes what is in paper space if model space has no curve, not even one that is hidden.
  DxfDrawing run(std::vector<std::string>& remarks) {
    visit_all();
    if (drawing_.shapes.empty() && hidden_curves_ == 0) {
      others_.clear(), drawing_.inserts.clear();
      hidden_ = visited_ = 0;
      is_paper_ = true;
      visit_all();
    }
    if (drawing_.shapes.empty() && hidden_curves_ > 0)
      text_.fail_at(text_.text().size(), "a curve that is shown",
                    fmt::format("{} entities that are invisible, or on a layer that is off or frozen", hidden_curves_));
    tell(remarks);
    return std::move(drawing_);
  }

 private:
  void visit_all() {
    const DxfDocument& document = drawing_.document;
    for (std::uint32_t e = document.first_drawn; e < document.end_drawn; ++e)
      visit(e, {}, DxfDrawing::kNone, Sight::Shown);
  }

  static constexpr std::size_t kMostEntities = 1000000, kDeepest = 100;

  /// Draws an entity. `outer` is what hides the INSERT that shows it: what is on the layer 0 of a block is on that of
  /// the INSERT.
  void visit(std::uint32_t number, const DxfPlacement& placement, std::uint32_t shown_by, Sight outer) {
    const DxfEntity& entity = drawing_.document.entities[number];
    const Sight sight = sight_of(entity, outer, shown_by);
    const bool is_shown = sight == Sight::Shown || (sight == Sight::LayerOff && entity.kind == DxfKind::Insert);
    if (!is_shown || entity.kind == DxfKind::Other) {
      if (shown_by != DxfDrawing::kNone) mark_other(shown_by, entity.begin);
      if (is_shown) ++others_[name_of(entity)];
      else ++hidden_;
      hidden_curves_ += !is_shown && sight != Sight::OtherSpace && entity.kind != DxfKind::Other;
      return;
    }
    if (entity.kind == DxfKind::Insert) {
      insert(number, placement, shown_by, sight);
      return;
    }
    held_.add();
    drawing_.shapes.push_back({number, shown_by});
  }

  Sight sight_of(const DxfEntity& entity, Sight outer, std::uint32_t shown_by) const {
    std::string_view layer;
    bool is_hidden = false, is_paper = false;
    text_.for_each_own(entity.begin, entity.body_end, [&](const DxfGroup& group) {
      if (group.code == 8) layer = group.value;
      else if (group.code == 60) is_hidden = is_hidden || text_.integer(group) == 1;
      else if (group.code == 67) is_paper = is_paper || text_.integer(group) == 1;
    });
    if (shown_by == DxfDrawing::kNone && is_paper != is_paper_) return Sight::OtherSpace;
    if (is_hidden) return Sight::Hidden;
    if (layer == "0" && shown_by != DxfDrawing::kNone) return outer;
    const auto found = drawing_.document.layers.find(dxf_key(layer));
    if (found == drawing_.document.layers.end()) return Sight::Shown;
    return found->second.is_frozen ? Sight::Hidden : found->second.is_off ? Sight::LayerOff : Sight::Shown;
  }

  std::string name_of(const DxfEntity& entity) const {
    std::uint64_t at = entity.begin;
    DxfGroup group;
    text_.next(at, group);
    return in_short(group.value);
  }

  /// Notes that a block, and with it those that it is in, hold something that is no curve.
  void mark_other(std::uint32_t insert, std::uint64_t at) {
    for (; insert != DxfDrawing::kNone && drawing_.inserts[insert].other == 0;
         insert = drawing_.inserts[insert].shown_by)
      drawing_.inserts[insert].other = at;
  }

  std::uint32_t block_of(const DxfEntity& entity) const {
    std::string_view name;
    text_.for_each_own(entity.begin, entity.body_end, [&](const DxfGroup& group) {
      if (group.code == 2) name = group.value;
    });
    const auto found = drawing_.document.block_by_name.find(dxf_key(name));
    if (found == drawing_.document.block_by_name.end())
      text_.fail_at(entity.begin, fmt::format("a block '{}'", in_short(name)), "none of this name");
    if (std::find(active_.begin(), active_.end(), found->second) != active_.end())
      text_.fail_at(entity.begin, "an INSERT of something else than it is part of", "a circle");
    return found->second;
  }

  /// How many columns or rows an INSERT has: one if it does not say so.
  std::int64_t count_of(const DxfValues& values, int code, const DxfEntity& entity) const {
    const double count = values.value(code, 1);
    if (!(count <= static_cast<double>(kMostEntities)))
      text_.fail_at(entity.begin, fmt::format("INSERT of {} entities at most", kMostEntities),
                    fmt::format("more, as {:g} columns or rows", count));
    return static_cast<std::int64_t>(std::max(1.0, count));
  }

  void insert(std::uint32_t number, const DxfPlacement& placement, std::uint32_t shown_by, Sight sight) {
    const DxfEntity entity = drawing_.document.entities[number];
    const std::uint32_t block = block_of(entity);
    const DxfValues values(text_, entity, {10, 20, 30, 41, 42, 43, 44, 45, 50, 70, 71});
    const Vec3d at = values.point(10), base = drawing_.document.blocks[block].base;
    const Vec3d scale(values.value(41, 1), values.value(42, 1), values.value(43, 1));
    if (scale[0] == 0 || scale[1] == 0) text_.fail_at(entity.begin, "an INSERT with scales that are not 0", "0");
    if (active_.size() == kDeepest)
      text_.fail_at(entity.begin, fmt::format("INSERT of blocks in blocks up to {} deep", kDeepest), "more");
    const double turn = values.value(50) * std::numbers::pi / 180, quarters = values.value(50) / 90;
    const bool is_square = quarters == std::floor(quarters);  // cosines without rounding
    const double c = is_square ? std::round(std::cos(turn)) : std::cos(turn),
                 s = is_square ? std::round(std::sin(turn)) : std::sin(turn);
    const DxfPlacement seen = is_mirrored(text_, entity) ? product(placement, kDxfMirrored) : placement;
    const std::int64_t columns = count_of(values, 70, entity), rows = count_of(values, 71, entity);
    active_.push_back(block);
    for (std::int64_t row = 0; row < rows; ++row)
      for (std::int64_t column = 0; column < columns; ++column) {
        const double x = static_cast<double>(column) * values.value(44),
                     y = static_cast<double>(row) * values.value(45);
        const SvgMatrix to_place{c, s, -s, c, at[0] + c * x - s * y, at[1] + s * x + c * y};
        const SvgMatrix from_base{scale[0], 0, 0, scale[1], -scale[0] * base[0], -scale[1] * base[1]};
        const DxfPlacement own{product(to_place, from_base), scale[2], at[2] - scale[2] * base[2]};
        show(block, number, product(seen, own), shown_by, sight);
      }
    active_.pop_back();
  }

  void show(std::uint32_t block, std::uint32_t number, const DxfPlacement& placement, std::uint32_t shown_by,
            Sight sight) {
    const DxfDocument& document = drawing_.document;
    const std::uint32_t first = document.blocks[block].first_entity, end = document.blocks[block].end_entity;
    visited_ += end - first + 1;
    if (visited_ > kMostEntities)
      text_.fail_at(document.entities[number].begin, fmt::format("INSERT of {} entities at most", kMostEntities),
                    "more");
    const auto own = static_cast<std::uint32_t>(drawing_.inserts.size());
    drawing_.inserts.push_back({number, shown_by, placement});
    const DxfEntity& insert = document.entities[number];
    if (insert.end > insert.body_end) mark_other(own, insert.body_end);  // its attributes
    for (std::uint32_t e = first; e < end; ++e) visit(e, placement, own, sight);
  }

  void tell(std::vector<std::string>& remarks) const {
    constexpr std::size_t kMostNames = 8;
    if (is_paper_ && !drawing_.shapes.empty())
      remarks.emplace_back("its curves are those of paper space, as model space has none");
    if (!others_.empty()) {
      std::string names;
      std::size_t named = 0, left = 0;
      for (const auto& [name, count] : others_) {
        if (named++ < kMostNames) names += fmt::format("{}{} {}", names.empty() ? "" : ", ", count, name);
        else left += count;
      }
      if (left > 0) names += fmt::format(", {} more", left);
      remarks.push_back(fmt::format("not curves, copied unchanged: {}", names));
    }
    if (hidden_ > 0)
      remarks.push_back(fmt::format(
          "what is not shown stays as it is: {} in {} space, invisible, or on a layer that is off or frozen", hidden_,
          is_paper_ ? "model" : "paper"));
  }

  const DxfText& text_;
  DxfDrawing drawing_;
  std::vector<std::uint32_t> active_;
  std::map<std::string, std::size_t> others_;
  std::size_t hidden_ = 0, hidden_curves_ = 0, visited_ = 0;
  bool is_paper_ = false;  // whether paper space is gone through, not model space
  MemoryWatch held_{text_.path(), sizeof(DxfDrawing::Shape)};
};

}  // namespace

DxfDrawing resolve_dxf(const DxfText& text, DxfDocument document, std::vector<std::string>& remarks) {
  return InsertResolver(text, std::move(document)).run(remarks);
}

}  // namespace vdb_offset::io
