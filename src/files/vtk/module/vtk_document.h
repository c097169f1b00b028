// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkPointSet.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <string>
#include <vector>

#include "document/document.h"
#include "vtk/module/vtk_header.h"

class vtkDataArray;

namespace vdb_offset::io {

/// A data set of VTK's, with all its arrays.
class VtkDocument : public Document {
 public:
  /// `cell` is the data set's cell of each face.
  VtkDocument(VtkHeader header, vtkSmartPointer<vtkPointSet> data, std::vector<std::int64_t> cell);

  WrittenDocument rewrite(const MovedMesh& moved) const override;
  bool takes_faces() const override { return true; }
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& derived, const std::string& path) const override;
  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  FaceNames face_names() const override;
  std::vector<double> vertex_numbers(const MeshFile& source, const std::string& name) const override;

  /// Three floating numbers a point that are its normal; or none.
  vtkDataArray* normals() const;
  /// All arrays that the data set has, in words.
  std::vector<std::string> arrays_in_words() const;

 private:
  /// A data set as a new file of the same kind.
  WrittenDocument as_new_file(vtkPointSet& data, const std::string& path) const;

  VtkHeader header_;
  vtkSmartPointer<vtkPointSet> data_;
  std::vector<std::int64_t> cell_;
};

/// A legacy file's bytes with other points and normals in them: the text of those that moved, or their numbers, stand
/// in the place of what they were. Nothing if the file's own numbers are not found there.
std::optional<std::string> rewrite_legacy(const MeshFile& source, bool ascii, vtkPointSet& before, vtkPointSet& after,
                                          vtkDataArray* old_normals, vtkDataArray* new_normals);

}  // namespace vdb_offset::io
