// SPDX-License-Identifier: Apache-2.0
#include "volume_arrays.h"

#include <array>

namespace vdb_offset::python {
namespace {

// VTK's numbers of cells, by CellType.
constexpr std::array<std::uint8_t, kCellTypeCount> kVtkTypes = {10, 14, 13, 12, 42, 5, 9};

std::vector<std::int64_t> vtk_cells(const VolumeMesh& mesh) {
  std::vector<std::int64_t> cells;
  cells.reserve(mesh.corners.size() + mesh.cell_count());
  for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
    const auto cell = mesh.cell(c);
    cells.push_back(static_cast<std::int64_t>(cell.size()));
    // VTK has prisms the other way round.
    if (mesh.cell_types[c] == CellType::Prism)
      for (const std::size_t k : {0, 2, 1, 3, 5, 4}) cells.push_back(cell[k]);
    else cells.insert(cells.end(), cell.begin(), cell.end());
  }
  return cells;
}

/// Fields as arrays of a shape; an empty one stands for as many values as there are.
py::dict fields_of(std::vector<VolumeField> fields, const std::vector<py::ssize_t>& shape = {}) {
  py::dict arrays;
  for (VolumeField& field : fields) {
    const std::vector<py::ssize_t> all = {static_cast<py::ssize_t>(field.values.size())};
    arrays[py::str(field.name)] = owning_array(std::move(field.values), shape.empty() ? all : shape);
  }
  return arrays;
}

}  // namespace

py::dict volume_as_dict(VolumeMesh mesh) {
  py::dict all, patches;
  std::vector<std::uint8_t> types;
  types.reserve(mesh.cell_count());
  for (const CellType type : mesh.cell_types) types.push_back(kVtkTypes[static_cast<std::size_t>(type)]);
  std::vector<std::int64_t> cells = vtk_cells(mesh);
  const auto length = static_cast<py::ssize_t>(cells.size()), count = static_cast<py::ssize_t>(types.size());
  all["cells"] = owning_array(std::move(cells), {length});
  all["cell_types"] = owning_array(std::move(types), {count});
  for (BoundaryPatch& patch : mesh.patches) {
    const auto begins = static_cast<py::ssize_t>(patch.face_begin.size()),
               corners = static_cast<py::ssize_t>(patch.corners.size());
    patches[py::str(patch.name)] = py::make_tuple(owning_array(std::move(patch.face_begin), {begins}),
                                                  owning_array(std::move(patch.corners), {corners}));
  }
  all["patches"] = patches;
  all["point_data"] = fields_of(std::move(mesh.point_fields));
  all["cell_data"] = fields_of(std::move(mesh.cell_fields));
  all["points"] = owning_array(std::move(mesh.points));
  return all;
}

py::dict block_as_dict(StructuredBlock block) {
  const std::vector<py::ssize_t> shape = {block.nk, block.nj, block.ni};
  py::dict all;
  all["point_data"] = fields_of(std::move(block.point_fields), shape);
  all["points"] = owning_array(std::move(block.points)).reshape({shape[0], shape[1], shape[2], py::ssize_t{3}});
  return all;
}

}  // namespace vdb_offset::python
