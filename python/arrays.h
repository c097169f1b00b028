// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

/// Between numpy's arrays and the library's spans and vectors.
namespace vdb_offset::python {

namespace py = pybind11;

/// A mesh, or curves, out of numpy's arrays, which it keeps alive. Nothing is copied of positions that are contiguous
/// doubles, nor of corners that are contiguous 32-bit integers.
class MeshArrays {
 public:
  /// Whether corners are copied in any case: for work that trusts them to be the same to its end, as a callback or
  /// another thread may change the array meanwhile.
  enum class Corners : bool { Shared, Copied };

  /// \param vertices (n, 3) numbers
  /// \param faces (m, k) integers; or a pair of one-dimensional arrays: m + 1 offsets, and the corners that they divide
  /// \throw InvalidInput for arrays of other shapes, or numbers that no vertex has
  MeshArrays(const py::object& vertices, const py::object& faces, Corners corners = Corners::Shared);

  PolygonView view() const { return {positions_, corners_, face_begin_}; }

 private:
  void take_corners(const py::handle& corners);
  void take_rows(const py::array& faces);
  void take_offsets(const py::handle& offsets);

  Corners keep_;
  py::object kept_positions_, kept_corners_;
  std::vector<std::uint32_t> copied_corners_;
  std::span<const Vec3d> positions_;
  std::span<const std::uint32_t> corners_;
  std::vector<std::uint32_t> face_begin_;
};

/// A shape as Python writes it.
std::string shape_of(const py::array& array);

/// A vector as an array that owns it: nothing is copied.
template <class Number>
py::array owning_array(std::vector<Number> values, std::vector<py::ssize_t> shape) {
  auto owned = std::make_unique<std::vector<Number>>(std::move(values));
  const Number* data = owned->data();
  const py::capsule owner(owned.get(), [](void* p) { delete static_cast<std::vector<Number>*>(p); });
  static_cast<void>(owned.release());
  return py::array_t<Number>(std::move(shape), data, owner);
}

/// Positions as an (n, 3) array of doubles that owns them.
py::array owning_array(std::vector<Vec3d> positions);

/// Faces as an (m, k) array if all have k corners, else as a pair of offsets and corners.
py::object faces_of(const Polygons& polygons);

/// The texture coordinates of vertices, out of (n, 2) numbers, one pair a vertex, or one a corner: (m, k, 2), or (c, 2)
/// for c corners in all. A vertex has those of its first corner that has any (NaNs are none). \throw InvalidInput
std::vector<Vec2d> texture_of(const py::object& texture, PolygonView mesh);

/// One mark a face, out of an array of booleans or the numbers of faces. \throw InvalidInput
std::vector<std::uint8_t> marks_of(const py::object& selection, std::size_t faces);

}  // namespace vdb_offset::python
