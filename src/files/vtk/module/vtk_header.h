// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// How a file of VTK's is made, as its first lines say.
struct VtkHeader {
  bool legacy = false, grid = false;  ///< An unstructured grid; else polygons.
  // Of XML files, what is kept as they are written again.
  bool ascii = false, appended = false, base64 = false, wide_counts = false, big_endian = false;
  std::string compressor;  ///< Its name in VTK; empty: none.
};

/// Reads what VTK's readers take as it is, and would make room for: the file's kind, and how many things it promises.
/// \throw InvalidInput for another file, and for one that promises more than its bytes can hold
VtkHeader read_vtk_header(const MeshFile& file);

}  // namespace vdb_offset::io
