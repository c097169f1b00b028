// SPDX-License-Identifier: Apache-2.0
#include "tessellate/tessellate.h"

#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>

#include "surface/make_triangles.h"
#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

constexpr int kSamples = 4;            // steps across a face, for the model's size
constexpr double kLeast = 2e-7;        // OpenCASCADE refuses what is below its own tolerance of 1e-7
constexpr std::size_t kMostNamed = 5;  // faces that a remark names
constexpr double kFarOff = 10;        // deflections: triangles that are farther off than that stand for another surface
constexpr double kLeastShare = 1e-7;  // of the diagonal: a finer deflection is refused as numberless triangles

double diagonal_of(const CadModel& model) {
  Bnd_Box box;
  for (const Body& body : model.bodies)
    for (const BodyFace& face : body.faces) {
      const FaceSurface surface(face.face);
      for (int i = 0; i <= kSamples; ++i)
        for (int j = 0; j <= kSamples; ++j)
          box.Add(surface.point(surface.first_u() + (surface.last_u() - surface.first_u()) * i / kSamples,
                                surface.first_v() + (surface.last_v() - surface.first_v()) * j / kSamples));
    }
  return box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
}

void mesh_faces(const CadModel& model, double deflection, double angle) {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const Body& body : model.bodies)
    for (const BodyFace& face : body.faces)
      if (!face.is_left_out) builder.Add(all, face.face);
  BRepTools::Clean(all);  // files may have triangles with them
  IMeshTools_Parameters parameters;
  parameters.Deflection = deflection;
  parameters.Angle = angle;
  parameters.AngleInterior = angle;
  parameters.InParallel = Standard_False;
  parameters.Relative = Standard_False;
  make_triangles(all, parameters);
}

/// Leaves out faces that have no triangles, as those that are no wider than a line; whether there are any.
bool leave_out_empty(Body& body) {
  bool is_any = false;
  for (BodyFace& face : body.faces) {
    face.is_left_out = !has_triangles(face.face);
    is_any = is_any || face.is_left_out;
  }
  return is_any;
}

/// Meshes all, and once more where faces came to nothing and their neighbours could be sewn to each other.
void mesh_all(CadModel& model, double diagonal, double deflection, double angle) {
  for (Body& body : model.bodies) sew_open_edges(body, model.tolerance, diagonal, model.remarks);
  mesh_faces(model, deflection, angle);
  bool is_sewn = false;
  for (Body& body : model.bodies)
    if (leave_out_empty(body)) is_sewn = sew_open_edges(body, model.tolerance, diagonal, model.remarks) || is_sewn;
  if (is_sewn) mesh_faces(model, deflection, angle);
}

/// Faces, by number and name.
std::string names_of(const std::vector<std::pair<std::size_t, std::string>>& faces) {
  std::string text = faces.size() == 1 ? "face" : "faces";
  for (std::size_t k = 0; k < std::min(faces.size(), kMostNamed); ++k) {
    text += (k > 0 ? ", " : " ") + std::to_string(faces[k].first);
    if (!faces[k].second.empty()) text += " (" + faces[k].second + ")";
  }
  if (faces.size() > kMostNamed) text += " and " + std::to_string(faces.size() - kMostNamed) + " more";
  return text;
}

std::size_t count_open_sides(const BodyMesh& mesh) {
  std::unordered_map<std::uint64_t, int> sides;
  for (const FaceMesh& face : mesh.faces)
    for (const Triangle& t : face.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        ++sides[BodyMesh::key(face.nodes[t[k]].vertex, face.nodes[t[(k + 1) % 3]].vertex)];
  return static_cast<std::size_t>(
      std::count_if(sides.begin(), sides.end(), [](const auto& s) { return s.second == 1; }));
}

/// What was done to all bodies together.
struct Work {
  std::size_t turned = 0, open_solids = 0, open_sides = 0, unmatched = 0;
  double farthest = 0;
  std::vector<std::pair<std::size_t, std::string>> missing;  // faces without area
  std::vector<std::pair<std::size_t, std::string>> holes;    // others that have no triangles
};

bool is_one_shell(const Body& body) {
  const std::vector<std::uint32_t> shell = shells_of(body);
  return std::all_of(shell.begin(), shell.end(), [](std::uint32_t first) { return first == 0; });
}

/// Turns faces of the model as their triangles were; a closed shell of no solid becomes one.
void orient_body(Body& body, BodyMesh& mesh, Work& work) {
  std::vector<double> before;
  for (const FaceMesh& face : mesh.faces) before.push_back(face.side);
  work.turned += orient(mesh, body.is_solid);
  for (std::size_t f = 0; f < before.size(); ++f)
    if (mesh.faces[f].side != before[f]) body.faces[f].face.Reverse();
  if (!body.is_solid && count_free_edges(body) == 0 && count_open_sides(mesh) == 0 && is_one_shell(body))
    body.is_solid = true;
}

BodyMesh append_tessellated(Body& body, double deflection, io::CadMesh& result, Work& work) {
  BodyMesh mesh = take_mesh(body);
  work.farthest = std::max(work.farthest, divide_to_deflection(mesh, deflection));
  place_on_surfaces(mesh);
  flip_slivers(mesh);
  orient_body(body, mesh, work);
  work.unmatched += mesh.unmatched;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    if (mesh.faces[f].is_missing)
      (has_area(body.faces[f].face) ? work.holes : work.missing)
          .emplace_back(result.faces.size() + f + 1, body.faces[f].facts.name);
  if (const std::size_t open = body.is_solid ? count_open_sides(mesh) : 0) ++work.open_solids, work.open_sides += open;
  append_body(mesh, body, result);
  return mesh;
}

void tell(const Work& work, double deflection, std::vector<std::string>& remarks) {
  if (!work.missing.empty()) remarks.push_back("OpenCASCADE finds no triangles for " + names_of(work.missing));
  if (work.turned > 0) remarks.push_back(std::to_string(work.turned) + " faces are turned round");
  if (work.unmatched > 0)
    remarks.push_back(std::to_string(work.unmatched) + " edges are divided in two ways by their faces");
  if (work.open_solids > 0)
    remarks.push_back(std::to_string(work.open_solids) + " solids are open, at " + std::to_string(work.open_sides) +
                      " edges of triangles");
  if (work.farthest <= deflection) return;
  char text[160];
  std::snprintf(text, sizeof(text), "triangles are up to %.3g from their faces, which is more than %.3g", work.farthest,
                deflection);
  remarks.emplace_back(text);
}

/// \throw InvalidCad for triangles that have little to do with their faces, as of a damaged file
void require_near(double farthest, double deflection) {
  if (farthest <= kFarOff * deflection) return;
  char text[200];
  std::snprintf(text, sizeof(text),
                "expected triangles within %.3g of their faces, got some %.3g off, as of a damaged file (a larger "
                "--deflection allows more)",
                deflection, farthest);
  throw InvalidCad(text);
}

double deflection_of(const io::CadFineness& fineness, double diagonal) {
  const double asked = fineness.deflection > 0 ? fineness.deflection : fineness.deflection_of_diagonal * diagonal;
  const double wanted = std::clamp(asked, fineness.least_of_diagonal * diagonal, fineness.most_of_diagonal * diagonal);
  if (!(diagonal > 0) || !std::isfinite(diagonal)) throw InvalidCad("expected faces of some size, got none");
  if (!(wanted >= kLeastShare * diagonal)) {
    char text[160];
    std::snprintf(
        text, sizeof(text),
        "expected a deflection of at least %.3g, which is 1e-7 of the model's diagonal, got %.3g (--deflection)",
        kLeastShare * diagonal, wanted);
    throw InvalidCad(text);
  }
  return wanted;
}

}  // namespace

Tessellation tessellate(CadModel& model, const io::CadFineness& fineness) {
  const double diagonal = diagonal_of(model), deflection = deflection_of(fineness, diagonal);
  mesh_all(model, diagonal, deflection, fineness.angle);
  Tessellation made;
  io::CadMesh& result = made.mesh;
  Work work;
  for (Body& body : model.bodies) made.bodies.push_back(append_tessellated(body, deflection, result, work));
  std::size_t face = 0;
  for (std::uint32_t b = 0; b < model.bodies.size(); ++b)
    for (std::size_t k = 0; k < model.bodies[b].faces.size(); ++k) result.faces[face++].body = b;
  result.deflection = std::max(deflection, work.farthest);
  result.unit_micrometres = model.unit_micrometres;
  result.has_unit = model.has_unit;
  result.extras = model.extras;
  result.remarks = model.remarks;
  tell(work, deflection, result.remarks);
  if (result.triangles.empty()) throw InvalidCad("expected faces that can be tessellated, got none");
  require_near(work.farthest, deflection);
  if (!work.holes.empty())
    throw InvalidCad("expected faces that can be tessellated, got none of " + names_of(work.holes) +
                     ", which would be holes");
  return made;
}

}  // namespace vdb_offset::cad
