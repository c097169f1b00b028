// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "threemf/transform.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

inline constexpr std::string_view kThreeMfCore = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
                                  kThreeMfMaterial = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

/// Where an object is put: an item of the build, or a component of another object.
struct ThreeMfPlacement {
  std::uint32_t object = 0;  ///< Its id.
  std::string part;          ///< The part that holds it; empty: this one. (Production extension)
  ThreeMfTransform transform;
  std::size_t at = 0;  ///< First byte of its element.
};

struct ThreeMfObject {
  std::uint32_t id = 0;
  std::string name, type = "model";
  std::size_t at = 0;             ///< First byte of its element.
  bool is_mesh = false;           ///< It has vertices and triangles; else it has components, or else `other`.
  bool has_exact_slices = false;  ///< Its mesh is a coarse one beside slices that count.
  std::string other;              ///< The name of an element of an extension that is in the place of a mesh.
  std::size_t first_vertex = 0, vertices = 0, first_triangle = 0, triangles = 0;
  std::vector<ThreeMfPlacement> components;
  std::uint32_t property = 0, property_index = 0;  ///< Of triangles without their own; 0: none.
};

/// The property of each corner of a triangle: the id of its group, and which of these.
struct ThreeMfProperty {
  std::uint32_t group = 0;
  std::array<std::uint32_t, 3> index{};
};

/// What a model part holds. Positions are in the objects' own frames.
struct ThreeMfModel {
  double unit_micrometres = 1000;
  std::vector<ThreeMfObject> objects;
  std::unordered_map<std::uint32_t, std::size_t> by_id;
  std::vector<ThreeMfPlacement> items;
  std::vector<Vec3d> positions;
  std::vector<std::uint64_t> vertex_at;  ///< First byte of each vertex' element.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<ThreeMfProperty> properties;  ///< Of triangles; empty unless asked for.
  std::vector<std::uint64_t> triangle_at;   ///< First byte of each triangle's element; empty unless asked for.
  std::uint32_t largest_id = 0;             ///< Of all resources.
  std::map<std::uint32_t, std::vector<std::string>> materials;          ///< Names, by their group's id.
  std::map<std::uint32_t, std::vector<std::array<double, 4>>> colours;  ///< By their group's id.
  std::set<std::string> extras;                                         ///< What it holds besides, in words.
};

/// Reads a model part. `label` begins messages.
/// \throw InvalidInput (line, what was expected, what was found)
ThreeMfModel read_model(const std::string& label, std::string_view text, bool with_properties = false);

/// The unit that a model part states at its beginning.
double unit_of_model(const std::string& label, std::string_view text);

/// The name of a unit that is so many micrometres long; empty if it has none.
std::string_view name_of_unit(double micrometres);

/// The target of the first relation of a package that leads to its model, as the archive has it.
std::string model_part(const std::string& label, std::string_view relations);

}  // namespace vdb_offset::io
