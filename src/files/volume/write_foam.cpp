// SPDX-License-Identifier: Apache-2.0
// Writes cells as a polyMesh of OpenFOAM: the texts points, faces, owner, neighbour and boundary in one folder. Faces
// are matched first (volume_faces.h). A face between two cells is written once, as the cell with the lower number has
// it, and all three lists of faces have one order. Patches follow by name, as walls or plain patches. The texts are
// made piece by piece on several threads, and do not depend on their number; the five files are put in place together
// or not at all. Coordinates have all of their digits. The mesh is measured as checkMesh does, and the measures are
// handed back; none of them makes this refuse a mesh. Fields of points and cells are not written.
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "products/volume/volume_faces.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "volume/volume_writers.h"

// https://doc.cfd.direct/openfoam/user-guide/mesh-description: faces between cells come first. Those of each cell
// towards cells of higher numbers follow each other, in the order of these numbers, with their normals towards them.
// Then come the faces of the patches.
namespace vdb_offset::io {
namespace {

struct FoamFile {
  const char* name;
  Pieces pieces;
};

std::string foam_header(const char* type, const char* object, const std::string& note = "") {
  return fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n{}    location    "
      "\"constant/polyMesh\";\n    object      {};\n}}\n\n",
      type, note.empty() ? "" : fmt::format("    note        \"{}\";\n", note), object);
}

/// A list as OpenFOAM writes it: its length, and its items in parentheses.
Pieces foam_list(const std::string& header, std::size_t count, std::vector<Section> sections) {
  return in_a_row({in_sections(fmt::format("{}{}\n(\n", header, count), std::move(sections)), in_sections(")\n", {})});
}

Pieces foam_points(const VolumeMesh& mesh) {
  return foam_list(foam_header("vectorField", "points"), mesh.points.size(),
                   {{mesh.points.size(), [&mesh](std::string& text, std::size_t p) {
                       text += '(';
                       for (int k = 0; k < 3; ++k) append_number(k > 0 ? text += ' ' : text, mesh.points[p][k]);
                       text += ")\n";
                     }}});
}

const char* type_of(BoundaryPatch::Kind kind) {
  switch (kind) {
    case BoundaryPatch::Kind::Wall:
      return "wall";
    case BoundaryPatch::Kind::Symmetry:
      return "symmetry";
    case BoundaryPatch::Kind::Empty:
      return "empty";
    case BoundaryPatch::Kind::Periodic:
      return "cyclic";
    default:
      return "patch";
  }
}

template <class Face>
void append_foam_face(std::string& text, const Face& face, std::size_t size) {
  append_integer(text, size);
  for (std::size_t k = 0; k < size; ++k) append_integer(text += k > 0 ? ' ' : '(', face[k]);
  text += ")\n";
}

class FoamWriter {
 public:
  explicit FoamWriter(const VolumeMesh& mesh) : mesh_(mesh), faces_(mesh), names_(patch_words(mesh)) {
    for (const BoundaryPatch& patch : mesh.patches) boundary_ += patch.face_count();
    inner_ = (faces_.side_count() - boundary_) / 2;
  }

  std::vector<FoamFile> files() const {
    return {{"points", foam_points(mesh_)},
            {"faces", faces()},
            {"owner", owner()},
            {"neighbour", neighbour()},
            {"boundary", in_sections(boundary(), {})}};
  }
  FoamQuality quality() const { return measure_foam(mesh_, faces_); }

 private:
  /// Lines for the faces between cells: calls append(text, cell, face) for each face of a cell towards a cell of a
  /// higher number.
  template <class Append>
  Section of_cells(Append append) const {
    return {mesh_.cell_count(), [this, append](std::string& text, std::size_t c) {
              thread_local std::vector<VolumeFaces::Side> upper;
              faces_.upper_faces(c, upper);
              for (const VolumeFaces::Side& side : upper) append(text, c, side);
            }};
  }

  Pieces faces() const {
    std::vector<Section> sections = {of_cells([this](std::string& text, std::size_t c, const VolumeFaces::Side& side) {
      const CellFace known = face(mesh_, c, side.local);
      append_foam_face(text, known, known.size);
    })};
    for (const BoundaryPatch& patch : mesh_.patches)
      sections.push_back({patch.face_count(), [&patch](std::string& text, std::size_t f) {
                            append_foam_face(text, patch.face(f), patch.face(f).size());
                          }});
    return foam_list(foam_header("faceList", "faces"), inner_ + boundary_, std::move(sections));
  }

  Pieces owner() const {
    std::vector<Section> sections = {of_cells([](std::string& text, std::size_t c, const VolumeFaces::Side&) {
      append_integer(text, c);
      text += '\n';
    })};
    for (const BoundaryPatch& patch : mesh_.patches)
      sections.push_back({patch.face_count(), [&patch](std::string& text, std::size_t f) {
                            append_integer(text, patch.cell[f]);
                            text += '\n';
                          }});
    return foam_list(foam_header("labelList", "owner", sizes()), inner_ + boundary_, std::move(sections));
  }

  Pieces neighbour() const {
    return foam_list(foam_header("labelList", "neighbour", sizes()), inner_,
                     {of_cells([](std::string& text, std::size_t, const VolumeFaces::Side& side) {
                       append_integer(text, side.cell);
                       text += '\n';
                     })});
  }

  std::string boundary() const {
    std::string text = foam_header("polyBoundaryMesh", "boundary") + fmt::format("{}\n(\n", mesh_.patches.size());
    std::size_t start = inner_;
    for (std::size_t i = 0; i < mesh_.patches.size(); ++i) {
      const BoundaryPatch& patch = mesh_.patches[i];
      text += fmt::format(
          "    {}\n    {{\n        type            {};\n        nFaces          {};\n"
          "        startFace       {};\n{}    }}\n",
          names_[i], type_of(patch.kind), patch.face_count(), start, coupling(i));
      start += patch.face_count();
    }
    return text + ")\n";
  }

  /// What OpenFOAM needs to know of one of two periodic patches.
  std::string coupling(std::size_t i) const {
    if (mesh_.patches[i].kind != BoundaryPatch::Kind::Periodic || !mesh_.motion) return "";
    std::size_t other = 0;
    while (other == i || mesh_.patches[other].kind != BoundaryPatch::Kind::Periodic) ++other;
    const auto vector = [](const Vec3d& v) { return fmt::format("({:.17g} {:.17g} {:.17g})", v[0], v[1], v[2]); };
    const PeriodicMotion& motion = *mesh_.motion;
    const std::string transform =
        motion.angle != 0 ? fmt::format(
                                "        transform       rotational;\n        rotationAxis    {};\n"
                                "        rotationCentre  {};\n",
                                vector(motion.axis), vector(motion.point))
                          : fmt::format("        transform       translational;\n        separationVector {};\n",
                                        vector(i < other ? motion.shift : -motion.shift));
    return fmt::format("        neighbourPatch  {};\n", names_[other]) + transform;
  }

  std::string sizes() const {
    return fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", mesh_.points.size(), mesh_.cell_count(),
                       inner_ + boundary_, inner_);
  }

  const VolumeMesh& mesh_;
  VolumeFaces faces_;
  std::vector<std::string> names_;
  std::size_t inner_ = 0, boundary_ = 0;
};

}  // namespace

FoamQuality write_foam(const std::string& path, const VolumeMesh& mesh) {
  std::filesystem::path folder = std::filesystem::path(path).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const FoamWriter writer(mesh);
  OutputFiles files;
  files.add_folders(folder);
  for (const FoamFile& file : writer.files()) write_pieces((folder / file.name).string(), file.pieces);
  files.commit();
  return writer.quality();
}

}  // namespace vdb_offset::io
