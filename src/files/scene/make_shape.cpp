// SPDX-License-Identifier: Apache-2.0
// Makes the shapes of scenes by their names, and reads the numbers that each of them takes.
#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include "scene/json_object.h"
#include "vdb_offset/scene.h"
#include "vdb_offset/shapes.h"

namespace vdb_offset::scene {

Polygons make_shape(JsonObject shape) {
  static const std::map<std::string, std::function<Polygons(JsonObject&)>> kMakers = {
      {"icosphere", [](JsonObject& r) { return shapes::icosphere(r.number("radius"), r.count("subdivisions")); }},
      {"uv_sphere",
       [](JsonObject& r) { return shapes::uv_sphere(r.number("radius"), r.count("segments"), r.count("rings")); }},
      {"hemisphere",
       [](JsonObject& r) { return shapes::hemisphere(r.number("radius"), r.count("segments"), r.count("rings")); }},
      {"cube",
       [](JsonObject& r) {
         return shapes::box(Vec3d(r.number("side")), r.count("divisions"), r.flag("triangles", false));
       }},
      {"torus",
       [](JsonObject& r) {
         return shapes::torus(r.number("major"), r.number("minor"), r.count("segments"), r.count("sides"));
       }},
      {"cylinder",
       [](JsonObject& r) {
         return shapes::cylinder(r.number("radius"), r.number("height"), r.count("segments"), r.count("stacks"),
                                 r.count("rings"));
       }},
      {"socket",
       [](JsonObject& r) {
         return shapes::socket(r.number("radius"), r.number("depth"), r.number("wall"), r.count("segments"),
                               r.count("stacks"));
       }},
      {"plates",
       [](JsonObject& r) {
         return shapes::plates(r.number("width"), r.number("thickness"), r.number("gap"), r.count("divisions"));
       }},
      {"wedge",
       [](JsonObject& r) {
         return shapes::wedge(r.number("angle"), r.number("length"), r.number("width"), r.count("divisions"));
       }},
      {"room_corner", [](JsonObject& r) { return shapes::room_corner(r.number("side"), r.count("divisions")); }},
      {"diffuser",
       [](JsonObject& r) {
         return shapes::diffuser(r.number("inlet"), r.number("outlet"), r.number("length"), r.count("divisions"));
       }},
      {"naca_wing",
       [](JsonObject& r) {
         return shapes::naca_wing(r.text("digits"), r.number("chord"), r.number("span"), r.count("points"),
                                  r.count("stacks"));
       }},
      {"gear",
       [](JsonObject& r) {
         return shapes::gear(r.count("teeth"), r.number("root_radius"), r.number("tip_radius"), r.number("bore_radius"),
                             r.number("thickness"), r.count("stacks"));
       }},
      {"bumpy_sphere",
       [](JsonObject& r) {
         return shapes::bumpy_sphere(r.number("radius"), r.number("amplitude"), r.number("frequency"),
                                     static_cast<unsigned>(r.count("seed")), r.count("subdivisions"));
       }},
      {"hollow_box",
       [](JsonObject& r) { return shapes::hollow_box(r.number("side"), r.number("wall"), r.count("divisions")); }},
      {"patch",
       [](JsonObject& r) { return shapes::patch(r.number("side"), r.number("amplitude", 0), r.count("divisions")); }},
  };
  const std::string type = shape.text("type");
  const auto maker = kMakers.find(type);
  if (maker == kMakers.end()) {
    std::vector<std::string> names(kMakers.size());
    std::transform(kMakers.begin(), kMakers.end(), names.begin(), [](const auto& known) { return known.first; });
    shape.fail(fmt::format("a type among {}, not '{}',", fmt::join(names, ", "), io::in_short(type)));
  }
  Polygons mesh = maker->second(shape);
  shape.finish();
  return mesh;
}

}  // namespace vdb_offset::scene
