// SPDX-License-Identifier: Apache-2.0
// Writes the HTML file that shows a run in a browser. The source and the surfaces made of it go in; if they have more
// triangles than are shown, view_mesh.cpp leaves fewer vertices, those that are farthest from what was asked before
// others. What is shown becomes arrays of numbers, positions as seen from one centre in single precision, and
// everything else JSON. Both are filled into the page that the library was built with, together with the viewer's
// scripts. Text from outside is escaped so that it cannot end an element of the page. Figures and counts are of all
// vertices, shown or not; of faults, no more than a bound are marked. The bytes do not depend on the number of threads.
// Nothing is measured here, and the page loads nothing.
#include "vdb_offset/io/view_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "page/page_arrays.h"
#include "page/page_figures.h"
#include "page/page_parts.h"
#include "page/view_mesh.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

/// How far each vertex is from what was asked, on the surface where that is most: what is wrong has to stay in view.
std::vector<float> weights_of(const Page& page, const std::vector<std::vector<float>>& shares) {
  std::vector<float> weights(page.source.positions.size(), 0.0F);
  for (std::size_t s = 0; s < shares.size(); ++s)
    for (std::size_t v = 0; v < shares[s].size(); ++v) {
      const std::span<const VertexState> states = page.surfaces[s].states;
      const bool is_short = !states.empty() && falls_short(states[v]);
      const float off = std::isnan(shares[s][v]) ? 0.0F : std::abs(1 - shares[s][v]);
      // A vertex that falls short comes before all that are mitered.
      weights[v] = std::max(weights[v], is_short ? 1e6F + off : off);
    }
  return weights;
}

Vec3d centre_of(std::span<const Vec3d> positions, std::span<const std::uint32_t> vertices) {
  Vec3d low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  for (const std::uint32_t v : vertices)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], positions[v][k]);
      high[k] = std::max(high[k], positions[v][k]);
    }
  return vertices.empty() ? Vec3d(0.0) : (low + high) / 2;
}

/// Numbers of those that are shown, in their order.
template <class Number, class Of>
std::vector<Number> taken(std::span<const std::uint32_t> shown, const Of& of) {
  std::vector<Number> numbers;
  numbers.reserve(shown.size());
  for (const std::uint32_t i : shown) numbers.push_back(static_cast<Number>(of(i)));
  return numbers;
}

/// Positions as seen from a centre: single precision is enough for a view, wherever the mesh stands.
std::vector<float> seen_from(const Vec3d& centre, const std::function<Vec3d(std::size_t)>& position,
                             std::span<const std::uint32_t> shown) {
  std::vector<float> numbers;
  numbers.reserve(3 * shown.size());
  for (const std::uint32_t v : shown) {
    const Vec3d from_centre = position(v) - centre;
    for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(from_centre[k]));
  }
  return numbers;
}

bool has_groups(const Page& page) { return page.groups && !page.groups->of_face.empty(); }

/// Faults of so many faces are marked at most; far more are seen without marks.
constexpr std::size_t kMostMarkedFaults = 100'000;

/// Puts the faults of a surface into the arrays: where the faces' centres are, their numbers, and what is wrong.
/// Returns how many there are.
std::size_t add_faults(const Page& page, const PageSurface& surface, const std::string& name, const Vec3d& centre,
                       PageArrays& arrays) {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < surface.face_faults.size(); ++f)
    if (surface.face_faults[f] != FaceFault::None) faces.push_back(f);
  const std::size_t count = faces.size();
  if (count == 0) return 0;
  faces.resize(std::min(count, kMostMarkedFaults));
  const auto middle = [&](std::size_t f) {
    const auto face = page.source.face(f);
    Vec3d sum(0.0);
    for (const std::uint32_t v : face) sum += surface.position(v);
    return sum / static_cast<double>(face.size());
  };
  arrays.add(name + ".fault_at", seen_from(centre, middle, faces));
  arrays.add(name + ".fault", taken<std::uint8_t>(faces, [&](std::uint32_t f) { return surface.face_faults[f]; }));
  arrays.add(name + ".fault_face", faces);
  if (has_groups(page))
    arrays.add(name + ".fault_group", taken<std::uint32_t>(faces, [&](auto f) { return page.groups->of_face[f]; }));
  return count;
}

/// Puts what is known of a surface into the arrays, and returns what the page says of it.
nlohmann::json add_surface(const PageSurface& surface, std::span<const float> shares, const std::string& name,
                           const ViewMesh& view, const Vec3d& centre, PageArrays& arrays) {
  nlohmann::json facts = {{"name", surface.name}, {"histogram", histogram_of_shares(shares, surface.states)}};
  arrays.add(name + ".positions", seen_from(centre, surface.position, view.vertices));
  arrays.add(name + ".share", taken<float>(view.vertices, [&](std::uint32_t v) { return shares[v]; }));
  if (!surface.states.empty()) {
    facts["states"] = counts_of_states(surface.states);
    arrays.add(name + ".state", taken<std::uint8_t>(view.vertices, [&](std::uint32_t v) { return surface.states[v]; }));
  }
  if (!surface.achieved.empty())
    arrays.add(name + ".achieved", taken<float>(view.vertices, [&](std::uint32_t v) { return surface.achieved[v]; }));
  if (surface.target && surface.target->uniform()) facts["target"] = (*surface.target)[0];
  else if (surface.target)
    arrays.add(name + ".target", taken<float>(view.vertices, [&](std::uint32_t v) { return (*surface.target)[v]; }));
  if (!surface.face_errors.empty())
    arrays.add(name + ".error", taken<float>(view.face, [&](std::uint32_t f) { return surface.face_errors[f]; }));
  return facts;
}

/// Puts what is drawn of a mesh into the arrays, whose names begin with `name`.
void add_mesh(const ViewMesh& view, const std::string& name, PageArrays& arrays) {
  arrays.add(name + "vertex", view.vertices);
  arrays.add(name + "corners", view.corners);
  arrays.add(name + "face", view.face);
  arrays.add(name + "edges", view.edges);
}

nlohmann::json counts_of(const ViewMesh& view) {
  return {{"elements", view.element_count()}, {"of", view.elements_of_mesh}};
}

/// Puts a surface with a mesh of its own into the arrays, and returns what the page says of it.
nlohmann::json add_own(const PageSurface& surface, bool are_curves, std::size_t most, const std::string& name,
                       const Vec3d& centre, PageArrays& arrays) {
  const PolygonView& mesh = *surface.own;
  const ViewMesh view = view_of(mesh, are_curves, std::vector<float>(mesh.positions.size(), 0.0F), most);
  const auto position = [&](std::size_t v) { return mesh.positions[v]; };
  add_mesh(view, name + ".", arrays);
  arrays.add(name + ".positions", seen_from(centre, position, view.vertices));
  return {{"name", surface.name}, {"shown", counts_of(view)}, {"vertices", mesh.positions.size()}};
}

nlohmann::json facts_of(const Page& page, PageArrays& arrays) {
  std::vector<std::vector<float>> shares;
  for (const PageSurface& surface : page.surfaces)
    shares.push_back(surface.own ? std::vector<float>() : shares_of(surface, page.source.positions.size()));
  const std::size_t most = page.most_triangles / (page.surfaces.size() + 1);
  const ViewMesh view = view_of(page.source, page.are_curves, weights_of(page, shares), most);
  const Vec3d centre = centre_of(page.source.positions, view.vertices);
  std::vector<std::string> states;
  for (std::size_t s = 0; s < kVertexStateCount; ++s) states.emplace_back(name(static_cast<VertexState>(s)));
  std::vector<std::string> fault_words;
  for (std::size_t f = 0; f < kFaceFaultCount; ++f) fault_words.emplace_back(name(static_cast<FaceFault>(f)));
  nlohmann::json facts = {{"title", page.title},
                          {"command", page.command},
                          {"curves", page.are_curves},
                          {"layers", page.are_layers},
                          {"centre", {centre[0], centre[1], centre[2]}},
                          {"states", states},
                          {"faults", fault_words},
                          {"vertices", page.source.positions.size()},
                          {"shown", counts_of(view)},
                          {"unit", page.unit},
                          {"up", page.up},
                          {"remarks", page.remarks},
                          {"surfaces", nlohmann::json::array()}};
  add_mesh(view, "", arrays);
  arrays.add("source.positions", seen_from(
                                     centre, [&](std::size_t v) { return page.source.positions[v]; }, view.vertices));
  if (has_groups(page)) {
    facts["groups"] = page.groups->names;
    arrays.add("group", taken<std::uint32_t>(view.face, [&](std::uint32_t f) { return page.groups->of_face[f]; }));
  }
  for (std::size_t s = 0; s < page.surfaces.size(); ++s) {
    const std::string name = fmt::format("surface{}", s);
    if (page.surfaces[s].own) {
      facts["surfaces"].push_back(add_own(page.surfaces[s], page.are_curves, most, name, centre, arrays));
      continue;
    }
    nlohmann::json surface = add_surface(page.surfaces[s], shares[s], name, view, centre, arrays);
    if (const std::size_t faults = add_faults(page, page.surfaces[s], name, centre, arrays)) surface["faults"] = faults;
    facts["surfaces"].push_back(std::move(surface));
  }
  if (!page.cell_quality.empty()) facts["quality"] = histogram_of_quality(page.cell_quality);
  facts["arrays"] = arrays.directory();
  return facts;
}

/// JSON as it may stand in a script element: nothing in it ends that, or begins a comment.
std::string in_script(std::string json) {
  for (std::size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at))
    json.replace(at, 1, "\\u003c");
  return json;
}

std::string in_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') escaped += "&amp;";
    else if (c == '<') escaped += "&lt;";
    else if (c == '>') escaped += "&gt;";
    else escaped += c;
  }
  return escaped;
}

/// Hands on the page, with each {{name}} replaced.
void fill(std::string_view page, const std::vector<std::pair<std::string_view, std::string_view>>& values,
          const Sink& sink) {
  for (;;) {
    const std::size_t open = page.find("{{"), close = page.find("}}", open);
    if (close == std::string_view::npos) return sink(page);
    sink(page.substr(0, open));
    const std::string_view name = page.substr(open + 2, close - open - 2);
    for (const auto& [known, value] : values)
      if (known == name) sink(value);
    page.remove_prefix(close + 2);
  }
}

}  // namespace

void require_pages(const std::string&) {}

void write_page(const std::string& path, const Page& page) {
  PageArrays arrays;
  const nlohmann::json facts = facts_of(page, arrays);
  // Names of files may be bytes that are no text.
  const std::string json = in_script(facts.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  const std::string title = in_html(facts["title"].get<std::string>()), packed = arrays.packed();
  const std::string report = in_script(page.report.empty() ? "null" : page.report);
  const PageParts parts = page_parts();
  const std::string licence = in_html(parts.viewer_licence);
  write_file(path, [&](const Sink& sink) {
    fill(parts.page,
         {{"title", title},
          {"style", parts.style},
          {"viewer", parts.viewer},
          {"controls", parts.controls},
          {"licence", licence},
          {"facts", json},
          {"report", report},
          {"arrays", packed},
          {"figures", parts.figures},
          {"view", parts.view},
          {"colours", parts.colours},
          {"places", parts.places},
          {"script", parts.script}},
         sink);
  });
}

}  // namespace vdb_offset::io
