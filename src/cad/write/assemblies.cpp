// SPDX-License-Identifier: Apache-2.0
#include "write/assemblies.h"

#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <TopLoc_Location.hxx>

#include <utility>

namespace vdb_offset::cad {
namespace {

using MaybePlace = std::optional<std::size_t>;

/// The innermost place that both are in. A place has a higher number than those above it.
MaybePlace common_place(MaybePlace a, MaybePlace b, std::span<const Place> places) {
  while (a && b && *a != *b) {
    MaybePlace& inner = *a > *b ? a : b;
    inner = places[*inner].above;
  }
  return a && b ? a : std::nullopt;
}

void set_name(const TDF_Label& label, const std::string& utf8) {
  TDataStd_Name::Set(label, TCollection_ExtendedString(utf8.c_str(), Standard_True));
}

}  // namespace

MaybePlace place_of(const Body& body, std::span<const Place> places) {
  if (body.faces.empty()) return std::nullopt;
  MaybePlace place = body.faces.front().place;
  for (const BodyFace& face : body.faces) place = common_place(place, face.place, places);
  return place;
}

Assemblies::Assemblies(opencascade::handle<XCAFDoc_ShapeTool> shapes, std::span<const Place> places)
    : shapes_(std::move(shapes)), places_(places) {}

void Assemblies::add(const TDF_Label& part, MaybePlace place) {
  if (!place) return;
  if (places_[*place].is_assembly) put(part, *place, {});
  else if (const MaybePlace above = places_[*place].above) put(part, *above, places_[*place].instance);
}

void Assemblies::put(const TDF_Label& what, std::size_t place, const std::string& instance) {
  const TDF_Label label = shapes_->AddComponent(assembly_at(place), what, TopLoc_Location());
  if (!instance.empty()) set_name(label, instance);
}

TDF_Label Assemblies::assembly_at(std::size_t place) {
  const auto [entry, is_new] = made_.try_emplace(place);
  if (!is_new) return entry->second;
  entry->second = shapes_->NewShape();
  const Place& own = places_[place];
  if (!own.product.empty()) set_name(entry->second, own.product);
  if (own.above) put(entry->second, *own.above, own.instance);
  return entry->second;
}

}  // namespace vdb_offset::cad
