#include "vdb_offset/io/convert.h"

#include <fmt/format.h>

#include <array>

#include "vdb_offset/io/numbers.h"
#include "vdb_offset/triangulate.h"

namespace vdb_offset::io {
namespace {

// Vertices or faces in a piece of a file.
constexpr std::size_t kPerPiece = 1 << 15;

using AppendVertex = std::function<void(std::string&, const Vec3d&)>;
using AppendFace = std::function<void(std::string&, std::span<const std::uint32_t>)>;

/// A header, all vertices, then all faces.
Pieces indexed(PolygonView mesh, std::string header, AppendVertex append_vertex, AppendFace append_face) {
  const auto pieces_of = [](std::size_t items) { return (items + kPerPiece - 1) / kPerPiece; };
  const std::size_t of_vertices = pieces_of(mesh.positions.size()), of_faces = pieces_of(mesh.face_count());
  return {1 + of_vertices + of_faces, [=](std::size_t piece) {
            if (piece == 0) return header;
            std::string bytes;
            const bool vertices = piece <= of_vertices;
            const std::size_t first = (piece - 1 - (vertices ? 0 : of_vertices)) * kPerPiece;
            if (vertices)
              for (std::size_t v = first; v < std::min(first + kPerPiece, mesh.positions.size()); ++v)
                append_vertex(bytes, mesh.positions[v]);
            else
              for (std::size_t f = first; f < std::min(first + kPerPiece, mesh.face_count()); ++f)
                append_face(bytes, mesh.face(f));
            return bytes;
          }};
}

void append_point(std::string& text, const Vec3d& p, const Precision& precision) {
  for (int k = 0; k < 3; ++k) {
    if (k > 0) text += ' ';
    append_number(text, p[k], precision);
  }
  text += '\n';
}

Pieces to_obj(PolygonView mesh, const Precision& precision) {
  return indexed(
      mesh, {},
      [=](std::string& text, const Vec3d& p) {
        text += "v ";
        append_point(text, p, precision);
      },
      [](std::string& text, std::span<const std::uint32_t> face) {
        text += 'f';
        for (const std::uint64_t v : face) {
          text += ' ';
          append_integer(text, v + 1);
        }
        text += '\n';
      });
}

Pieces to_off(PolygonView mesh, const Precision& precision) {
  return indexed(
      mesh, fmt::format("OFF\n{} {} 0\n", mesh.positions.size(), mesh.face_count()),
      [=](std::string& text, const Vec3d& p) { append_point(text, p, precision); },
      [](std::string& text, std::span<const std::uint32_t> face) {
        append_integer(text, face.size());
        for (const auto v : face) {
          text += ' ';
          append_integer(text, v);
        }
        text += '\n';
      });
}

Pieces to_ply(PolygonView mesh) {
  return indexed(
      mesh,
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
                  "property double z\nelement face {}\nproperty list uint uint vertex_indices\nend_header\n",
                  mesh.positions.size(), mesh.face_count()),
      [](std::string& bytes, const Vec3d& p) {
        for (int k = 0; k < 3; ++k) append_binary(bytes, p[k]);
      },
      [](std::string& bytes, std::span<const std::uint32_t> face) {
        append_binary(bytes, static_cast<std::uint32_t>(face.size()));
        for (const auto v : face) append_binary(bytes, v);
      });
}

void append_facet(std::string& bytes, const std::array<Vec3d, 3>& corner) {
  Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  if (normal.length() > 0) normal /= normal.length();
  for (const Vec3d& row : {normal, corner[0], corner[1], corner[2]})
    for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(row[k]));
  append_binary(bytes, std::uint16_t{0});
}

Pieces to_stl(PolygonView mesh) {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  const auto triangles = std::make_shared<Triangles>();
  for (std::size_t f = 0; f < mesh.face_count(); ++f) triangulate(mesh.positions, mesh.face(f), *triangles);
  const std::size_t pieces = 1 + (triangles->size() + kPerPiece - 1) / kPerPiece;
  return {pieces, [=](std::size_t piece) {
            std::string bytes;
            if (piece == 0) {
              bytes.assign(80, '\0');
              append_binary(bytes, static_cast<std::uint32_t>(triangles->size()));
              return bytes;
            }
            const std::size_t first = (piece - 1) * kPerPiece;
            const Precision single{Precision::Kind::Single};
            for (std::size_t t = first; t < std::min(first + kPerPiece, triangles->size()); ++t) {
              const auto& [a, b, c] = (*triangles)[t];
              append_facet(bytes, {single(mesh.positions[a]), single(mesh.positions[b]), single(mesh.positions[c])});
            }
            return bytes;
          }};
}

}  // namespace

Pieces encode(Format format, PolygonView mesh, const Precision& precision) {
  switch (format) {
    case Format::Obj:
      return to_obj(mesh, precision);
    case Format::Off:
      return to_off(mesh, precision);
    case Format::Ply:
      return to_ply(mesh);
    case Format::Stl:
      break;
  }
  return to_stl(mesh);
}

std::string lost_on_conversion(const MeshFile& source, Format target) {
  std::vector<std::string> lost = source.extras;
  if (target == Format::Stl && source.format != Format::Stl) {
    lost.emplace_back("shared vertices");
    const auto& begin = source.polygons.face_begin;
    for (std::size_t f = 0; f + 1 < begin.size(); ++f)
      if (begin[f + 1] - begin[f] > 3) {
        lost.emplace_back("faces of more than three corners (split into triangles)");
        break;
      }
    lost.emplace_back("digits beyond single precision");
  }
  return fmt::format("{}", fmt::join(lost, ", "));
}

}  // namespace vdb_offset::io
