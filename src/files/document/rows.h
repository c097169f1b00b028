// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "document/document.h"

namespace vdb_offset::io {

/// A file that is a mesh and little else, vertex by vertex and face by face (OBJ, OFF, PLY, STL, and curves in text):
/// it is written again by replacing numbers where they stand, and can be given more rows.
class Rows : public Document {
 public:
  /// What ends a number in a text besides white space.
  struct Syntax {
    char comment = '\0';       ///< Begins a comment; 0: there are none.
    bool joins_lines = false;  ///< A backslash at the end of a line joins it to the next one.
  };

  Rows() = default;
  explicit Rows(const Syntax& syntax) : syntax_(syntax) {}

  ByteOffsets position_at;  ///< First byte of each coordinate of each vertex, in the order of the mesh's positions.
  /// First byte of each number of each of the file's normals, in their own order. OBJ: `vn` lines; OFF, PLY: one a
  /// vertex; STL: one a facet.
  ByteOffsets normal_at;
  /// OBJ: the normal that each face corner names, kNoNormal where it names none. Empty if no corner does.
  std::vector<std::uint32_t> corner_normal;
  std::uint8_t position_bytes = 0, normal_bytes = 0;  ///< Size of a binary number: 4 or 8; 0 for text.
  /// Lines end with a carriage return alone. MeshFile::bytes has a line feed in the place of each.
  bool has_carriage_returns = false;

  const Syntax& syntax() const { return syntax_; }
  const Rows* rows() const override { return this; }
  WrittenDocument rewrite(const MovedMesh& moved) const override;
  std::vector<double> vertex_numbers(const MeshFile& source, const std::string& name) const override;

  /// Each face is a row of its own, but not in strips of triangles.
  bool takes_faces() const override { return true; }
  /// The file with a row for each face, if it has none. `lost` gets what it cannot keep.
  virtual std::string with_face_rows(const MeshFile& source, std::vector<std::string>& lost) const;
  /// Whether faces may have vertices in common.
  virtual bool shares_vertices() const { return true; }

 private:
  Syntax syntax_;
};

/// \pre has_rows(file)
const Rows& rows_of(const MeshFile& file);

/// The source's own bytes from one to another, with other coordinates where a vertex moved and other normals where
/// there are new ones. Lines end with line feeds. The pieces refer to `source` and `positions`; those of a text begin
/// where cut_at_lines() cuts it. \pre has_rows(source), and no number goes over the ends
Pieces rewrite_rows(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                    std::shared_ptr<const NewNormals> normals, std::size_t begin, std::size_t end);

/// All of the source's bytes as rewrite_rows() has them, with the line ends of the file.
Pieces rewrite_in_place(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                        std::shared_ptr<const NewNormals> normals = std::make_shared<NewNormals>());

/// A text whose lines end with line feeds, with the line ends of a source.
Pieces with_line_ends_of(const MeshFile& source, Pieces pieces);

/// Replaces carriage returns of a text by line feeds, if its lines end with these alone, as those of old Macs do.
/// Returns whether they did.
bool use_line_feeds(MeshFile& file);

}  // namespace vdb_offset::io
