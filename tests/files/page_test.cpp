// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "bytes/compression.h"
#include "page/view_mesh.h"
#include "support/folder.h"
#include "vdb_offset/io/view_file.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

std::string bytes_of_base64(const std::string& text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

/// The content of one of a page's script elements.
std::string element(const std::string& page, const std::string& name) {
  const std::size_t begin = page.find('>', page.find("id=\"" + name + "\"")) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

/// A page as a browser would take it apart.
struct ReadPage {
  std::string text;
  nlohmann::json facts;
  std::string numbers;

  explicit ReadPage(std::string page)
      : text(std::move(page)),
        facts(nlohmann::json::parse(element(text, "facts"))),
        numbers(io::decompress(io::Compression::Gzip, "page", bytes_of_base64(element(text, "arrays")))) {}

  template <class Number>
  std::vector<Number> array(const std::string& name) const {
    const nlohmann::json& entry = facts.at("arrays").at(name);
    std::vector<Number> values(entry.at("count").get<std::size_t>());
    std::memcpy(values.data(), numbers.data() + entry.at("at").get<std::size_t>(), values.size() * sizeof(Number));
    return values;
  }
};

/// A mesh, moved by one, whose vertices have all arrived but one.
struct Moved {
  Polygons mesh;
  std::vector<Vec3d> positions;
  std::vector<VertexState> states;
  std::vector<double> achieved;
  Distances target = 2.0;
  std::uint32_t held = 0;

  Moved(Polygons of, std::uint32_t short_vertex) : mesh(std::move(of)), positions(mesh.positions), held(short_vertex) {
    for (Vec3d& p : positions) p[0] += 1;
    states.assign(positions.size(), VertexState::Reached);
    achieved.assign(positions.size(), 2.0);
    states[held] = VertexState::Limited;
    achieved[held] = 0.5;
  }

  io::Page page() const {
    io::Page page;
    page.title = "a";
    page.source = mesh.view();
    io::PageSurface surface;
    surface.name = "offset";
    surface.position = [this](std::size_t v) { return positions[v]; };
    surface.states = states;
    surface.achieved = achieved;
    surface.target = &target;
    page.surfaces.push_back(surface);
    return page;
  }
};

ReadPage written(const Folder& folder, const io::Page& page) {
  io::write_page(folder.file("page.html"), page);
  return ReadPage(slurp(folder.file("page.html")));
}

}  // namespace

TEST_CASE("page: a mesh that is shown whole has its own vertices, triangles and edges", "[page]") {
  const Polygons box = shapes::box({1, 1, 1}, 3, false);
  const std::vector<float> weights(box.positions.size(), 0.0F);
  const io::ViewMesh view = io::view_of(box.view(), false, weights, 1000);
  CHECK_FALSE(view.is_decimated());
  CHECK(view.element_count() == 2 * box.face_count());
  CHECK(view.vertices.size() == box.positions.size());
  std::size_t sides = 0;
  for (const std::uint8_t edges : view.edges)
    for (int k = 0; k < 3; ++k) sides += edges >> k & 1;
  CHECK(sides == 4 * box.face_count());  // not the diagonals of quads
}

TEST_CASE("page: a large mesh is shown by vertices of its own, of which the worst is one", "[page]") {
  const Polygons sphere = shapes::icosphere(1, 5);
  std::vector<float> weights(sphere.positions.size(), 0.0F);
  constexpr std::uint32_t kWorst = 7777;
  weights[kWorst] = 1;
  const io::ViewMesh view = io::view_of(sphere.view(), false, weights, 2000);
  CHECK(view.is_decimated());
  CHECK(view.elements_of_mesh == sphere.face_count());
  CHECK(view.element_count() <= 2000);
  CHECK(view.element_count() > 500);
  CHECK(std::is_sorted(view.vertices.begin(), view.vertices.end()));
  CHECK(std::binary_search(view.vertices.begin(), view.vertices.end(), kWorst));
  for (const std::uint32_t v : view.vertices) REQUIRE(v < sphere.positions.size());
  for (const std::uint32_t corner : view.corners) REQUIRE(corner < view.vertices.size());
  // A rougher sphere, and nothing across it: an element is no longer than a few cells.
  for (std::size_t e = 0; e < view.element_count(); ++e)
    for (int k = 0; k < 3; ++k) {
      const Vec3d& a = sphere.positions[view.vertices[view.corners[3 * e + k]]];
      const Vec3d& b = sphere.positions[view.vertices[view.corners[3 * e + (k + 1) % 3]]];
      REQUIRE((a - b).length() < 0.5);
    }
}

TEST_CASE("page: both sides of what is thinner than a cell stay apart", "[page]") {
  const Polygons plate = shapes::box({1, 1, 1e-4}, 60, true);
  const std::vector<float> weights(plate.positions.size(), 0.0F);
  const io::ViewMesh view = io::view_of(plate.view(), false, weights, 800);
  std::size_t above = 0, below = 0;
  for (const std::uint32_t v : view.vertices) {
    above += plate.positions[v][2] > 0;
    below += plate.positions[v][2] < 0;
  }
  CHECK(above > 50);
  CHECK(below > 50);
}

TEST_CASE("page: positions, distances and states are those of the result, figures are of all vertices", "[page]") {
  const Folder folder;
  const Moved moved(shapes::icosphere(1, 4), 1234);
  io::Page page = moved.page();
  for (const std::size_t most : {std::size_t{600'000}, std::size_t{1000}}) {
    page.most_triangles = most;
    const ReadPage read = written(folder, page);
    const auto vertex = read.array<std::uint32_t>("vertex");
    const auto shares = read.array<float>("surface0.share");
    const auto states = read.array<std::uint8_t>("surface0.state");
    const auto positions = read.array<float>("surface0.positions");
    const auto centre = read.facts["centre"].get<std::vector<double>>();
    CHECK((vertex.size() == moved.positions.size()) == (most > 1000));
    for (std::size_t i = 0; i < vertex.size(); ++i) {
      const std::uint32_t v = vertex[i];
      REQUIRE(shares[i] == static_cast<float>(moved.achieved[v] / 2));
      REQUIRE(states[i] == static_cast<std::uint8_t>(moved.states[v]));
      for (int k = 0; k < 3; ++k)
        REQUIRE(positions[3 * i + k] == static_cast<float>(moved.positions[v][k] - centre[k]));
    }
    CHECK(std::count(states.begin(), states.end(), static_cast<std::uint8_t>(VertexState::Limited)) == 1);
    const nlohmann::json& surface = read.facts["surfaces"][0];
    CHECK(surface["states"][static_cast<std::size_t>(VertexState::Reached)] == moved.positions.size() - 1);
    CHECK(surface["histogram"]["at"] == moved.positions.size() - 1);
    CHECK(surface["histogram"]["below"][5] == 1);  // a quarter of its distance
    CHECK(surface["target"] == 2.0);
  }
}

TEST_CASE("page: names and reports end no element of it, whatever is in them", "[page]") {
  const Folder folder;
  const Moved moved(shapes::box({1, 1, 1}, 1, true), 0);
  io::Page page = moved.page();
  const std::size_t elements = [&] {
    const std::string text = written(folder, page).text;
    std::size_t count = 0;
    for (std::size_t at = text.find("<script"); at != std::string::npos; at = text.find("<script", at + 1)) ++count;
    return count;
  }();
  const std::string evil = "</script></title><script>alert(1)</script><!-- {{facts}} \xff";
  WallNames groups{{evil}, std::vector<std::uint32_t>(moved.mesh.face_count(), 0)};
  page.title = page.command = evil;
  page.report = nlohmann::json{{"input", "</script><script>"}}.dump();
  page.groups = &groups;
  page.remarks = {evil};
  page.surfaces[0].name = evil;
  const ReadPage read = written(folder, page);
  std::size_t count = 0;
  for (std::size_t at = read.text.find("<script"); at != std::string::npos; at = read.text.find("<script", at + 1))
    ++count;
  CHECK(count == elements);
  const std::string shown = evil.substr(0, evil.size() - 1) + "\uFFFD";
  CHECK(read.facts["command"] == shown);
  CHECK(read.facts["groups"][0] == shown);
  CHECK(nlohmann::json::parse(element(read.text, "report"))["input"] == "</script><script>");
}

TEST_CASE("page: a mesh alone has its unit and the axis that is up", "[page]") {
  const Folder folder;
  const Polygons box = shapes::box({1, 1, 1}, 2, false);
  io::Page page;
  page.source = box.view();
  page.unit = "mm";
  page.up = 1;
  const ReadPage read = written(folder, page);
  CHECK(read.facts["surfaces"].empty());
  CHECK(read.facts["unit"] == "mm");
  CHECK(read.facts["up"] == 1);
  CHECK(read.array<std::uint32_t>("corners").size() == 6 * box.face_count());
}

TEST_CASE("page: a surface with a mesh of its own has that, and no measures", "[page]") {
  const Folder folder;
  const Polygons box = shapes::box({1, 1, 1}, 1, true), ball = shapes::icosphere(2, 3);
  io::Page page;
  page.source = box.view();
  io::PageSurface& surface = page.surfaces.emplace_back();
  surface.name = "ball";
  surface.own = ball.view();
  const ReadPage read = written(folder, page);
  const nlohmann::json& facts = read.facts["surfaces"][0];
  CHECK(facts["vertices"] == ball.positions.size());
  CHECK_FALSE(facts.contains("histogram"));
  CHECK_FALSE(read.facts["arrays"].contains("surface0.share"));
  CHECK(read.array<std::uint32_t>("surface0.corners").size() == 3 * ball.face_count());
  const auto positions = read.array<float>("surface0.positions");
  const auto centre = read.facts["centre"].get<std::vector<double>>();
  REQUIRE(positions.size() == 3 * ball.positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    REQUIRE(positions[i] == static_cast<float>(ball.positions[i / 3][static_cast<int>(i % 3)] - centre[i % 3]));
}

TEST_CASE("page: faces with faults have their groups, so that they can be hidden", "[page]") {
  const Folder folder;
  const Moved moved(shapes::box({1, 1, 1}, 1, true), 0);
  WallNames groups{{"a", "b"}, std::vector<std::uint32_t>(moved.mesh.face_count(), 0)};
  std::vector<FaceFault> faults(moved.mesh.face_count(), FaceFault::None);
  groups.of_face[5] = 1;
  faults[3] = faults[5] = FaceFault::Inverted;
  io::Page page = moved.page();
  page.groups = &groups;
  page.surfaces[0].face_faults = faults;
  const ReadPage read = written(folder, page);
  CHECK(read.array<std::uint32_t>("surface0.fault_face") == std::vector<std::uint32_t>{3, 5});
  CHECK(read.array<std::uint32_t>("surface0.fault_group") == std::vector<std::uint32_t>{0, 1});
}

TEST_CASE("page: vertices without a distance have no share, and stand in no bar", "[page]") {
  const Folder folder;
  Moved moved(shapes::box({1, 1, 1}, 1, true), 0);
  moved.target = Distances(std::vector<double>(moved.positions.size(), 0.0));
  const ReadPage read = written(folder, moved.page());
  for (const float share : read.array<float>("surface0.share")) CHECK(std::isnan(share));
  CHECK(read.facts["surfaces"][0]["histogram"]["at"] == 0);
}

TEST_CASE("page: curves are shown by their segments", "[page]") {
  const Folder folder;
  Moved moved(Polygons{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 3, 0}, {0, 5}}, 2);
  io::Page page = moved.page();
  page.are_curves = true;
  const ReadPage read = written(folder, page);
  CHECK(read.array<std::uint32_t>("corners") == std::vector<std::uint32_t>{0, 1, 1, 2, 2, 3, 3, 0});
}
