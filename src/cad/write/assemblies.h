// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TDF_Label.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cstddef>
#include <map>
#include <optional>
#include <span>

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// Returns the innermost place that all faces of a body are in.
std::optional<std::size_t> place_of(const Body& body, std::span<const Place> places);

/// Makes a document's assemblies, by the places of the source: what is placed twice there is twice in the document, as
/// the two are not offset alike everywhere.
class Assemblies {
 public:
  Assemblies(opencascade::handle<XCAFDoc_ShapeTool> shapes, std::span<const Place> places);

  /// Puts a part, which lies where it is to be, into the assembly that its place is in, by its name there. Of no
  /// assembly, it stays by itself.
  void add(const TDF_Label& part, std::optional<std::size_t> place);

 private:
  TDF_Label assembly_at(std::size_t place);
  void put(const TDF_Label& what, std::size_t place, const std::string& instance);

  opencascade::handle<XCAFDoc_ShapeTool> shapes_;
  std::span<const Place> places_;
  std::map<std::size_t, TDF_Label> made_;
};

}  // namespace vdb_offset::cad
