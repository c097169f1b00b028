// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bytes/chunked_output.h"
#include "document/new_normals.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// What a file calls its faces: indices of names for each face; an empty name is none.
struct FaceNames {
  std::vector<std::string> groups, materials;
  std::vector<std::uint32_t> group_of, material_of;  ///< Of all faces, or empty.
  std::vector<std::string> layers = {};              ///< Of each group a second name, that of its layer; or empty.
  /// Of each material its colour: red, green and blue, 0 .. 1, sRGB. Empty: none is known.
  std::vector<std::optional<std::array<double, 3>>> colours = {};
};

/// The moved mesh that a document is to be written with.
struct MovedMesh {
  const MeshFile& source;  ///< Outlives the pieces that are made of it, as the positions do.
  std::span<const Vec3d> positions;
  Rounding precision;
  std::shared_ptr<const NewNormals> normals;  ///< One for each normal of the source; or none.
  std::string path;                           ///< Where it will be written.

  bool has_moved(std::size_t v) const { return io::has_moved(source.polygons.positions[v], positions[v], precision); }
  bool any_has_moved() const;
};

/// A file, and those that lie beside it, by their paths.
struct WrittenDocument {
  Pieces file;
  struct Beside {
    std::string path, bytes;
  };
  std::vector<Beside> beside;
  std::vector<std::string> lost;  ///< What of the source it does not hold, in words.
};

/// Puts it in place, and what lies beside it, together; nothing if the source's bytes have changed.
/// \throw ReadError, WriteError
void write_document(const std::string& path, const MeshFile& source, const WrittenDocument& written);

/// Receives the names of a file's faces, in its order. What is set holds for the faces after it.
class LabelListener {
 public:
  virtual ~LabelListener() = default;
  virtual void set_groups(std::vector<std::string> names) = 0;
  virtual void set_object(std::string name) = 0;
  virtual void set_material(std::string name) = 0;
  virtual void add_face() = 0;
};

/// What a file has a normal for.
enum class NormalsOf : std::uint8_t { Vertices, Corners, Facets };

class Rows;
class DerivedMesh;  // derived/derived_mesh.h

/// What the reader of a format keeps of a file, to write it again and to report what it holds besides a mesh.
class Document {
 public:
  Document() = default;
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  virtual ~Document() = default;

  /// The file in its own format, with all that it holds, over other positions.
  virtual WrittenDocument rewrite(const MovedMesh& moved) const = 0;

  /// Whether it can be written with other faces.
  virtual bool takes_faces() const { return false; }
  /// The file in its own format, with all that it holds, over a mesh that is made of its own; `path` is where it will
  /// be written. \pre takes_faces() \throw InvalidInput if the source's file has changed
  virtual WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& mesh, const std::string& path) const;

  /// Adds what other formats have a place for, too. `attributes.lost` comes with the source's extras; what is added is
  /// taken out of it.
  virtual void read_attributes(const MeshFile& source, Attributes& attributes) const;

  virtual FaceNames face_names() const;
  virtual Materials read_materials(const MeshFile& source) const;
  /// Calls the listener for the names of all faces; not at all if the file has none.
  virtual void visit_labels(const MeshFile& source, LabelListener& listener) const;

  virtual NormalsOf normals_of() const { return NormalsOf::Vertices; }
  /// This, if it is written by rows (document/rows.h).
  virtual const Rows* rows() const { return nullptr; }

  /// One number a face: 1 if the selector names it, which is not by a group, a material or a file. None if the format
  /// has no such names. \throw InvalidOption if there is no such face
  virtual std::optional<std::vector<std::uint8_t>> select(const MeshFile& source, const Selector& selector) const;

  /// The numbers that it holds for its vertices under a name.
  /// \throw InvalidInput if it has none of that name, or not one finite number for each
  virtual std::vector<double> vertex_numbers(const MeshFile& source, const std::string& name) const;
};

}  // namespace vdb_offset::io
