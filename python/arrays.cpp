// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/run.h"

namespace vdb_offset::python {
namespace {

static_assert(sizeof(Vec3d) == 3 * sizeof(double) && sizeof(Vec2d) == 2 * sizeof(double));

}  // namespace

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k) text += (k > 0 ? ", " : "") + std::to_string(array.shape(k));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

namespace {

/// An object as an array. What cannot be one for its type or value is reported in the library's way; other errors are
/// NumPy's.
py::array as_array(const py::handle& object, const char* what) {
  try {
    return py::array(py::reinterpret_borrow<py::object>(object));
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
    const std::string kind = py::str(py::type::of(object).attr("__name__"));
    throw InvalidInput(std::string(what) + (kind == "list" && std::string(what) == "faces"
                                                ? ": got a list of lists of unequal lengths; pass (offsets, corners)"
                                                : ": expected an array of numbers, got a " + kind));
  }
}

bool is_integral(const py::array& array) {
  const char kind = array.dtype().kind();
  return kind == 'i' || kind == 'u';
}

/// Integers as contiguous 32-bit ones: themselves, if they are.
py::array_t<std::uint32_t> as_indices(const py::array& array, const char* what) {
  // An empty list is an array of doubles.
  const bool is_empty = array.size() == 0 && array.dtype().kind() == 'f';
  if (!is_integral(array) && !is_empty)
    throw InvalidInput(std::string(what) + ": expected integers, got an array of " +
                       std::string(py::str(py::object(array.dtype()))));
  const bool is_contiguous = (array.flags() & py::array::c_style) != 0;
  if (is_contiguous && py::isinstance<py::array_t<std::uint32_t>>(array))
    return py::reinterpret_borrow<py::array_t<std::uint32_t>>(array);
  // What is negative becomes a number above all vertices'.
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> wide(array);
  py::array_t<std::uint32_t> indices(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()));
  std::transform(wide.data(), wide.data() + wide.size(), indices.mutable_data(), [](std::int64_t i) {
    return i < 0 || i >= std::int64_t{kNone} ? kNone : static_cast<std::uint32_t>(i);
  });
  return indices;
}

/// An element of an array, by its place, and what it is.
std::string place_of(const py::handle& object, std::ptrdiff_t index) {
  const py::array array = as_array(object, "faces");
  const auto size = array.ndim() == 2 ? static_cast<std::ptrdiff_t>(array.shape(1)) : 0;
  const py::object value = array.attr("item")(index);
  return (size > 0 ? "faces[" + std::to_string(index / size) + ", " + std::to_string(index % size)
                   : "faces: corners[" + std::to_string(index)) +
         "] is " + std::string(py::str(value));
}

}  // namespace

MeshArrays::MeshArrays(const py::object& vertices, const py::object& faces, Corners corners) : keep_(corners) {
  const py::array given = as_array(vertices, "vertices");
  const bool are_numbers = is_integral(given) || given.dtype().kind() == 'f';
  if (!are_numbers || given.ndim() != 2 || given.shape(1) != 3)
    throw InvalidInput("vertices: expected numbers of the shape (n, 3), got " + shape_of(given) + " of " +
                       std::string(py::str(py::object(given.dtype()))));
  const py::array_t<double, py::array::c_style | py::array::forcecast> positions(given);
  kept_positions_ = positions;
  positions_ = {reinterpret_cast<const Vec3d*>(positions.data()), static_cast<std::size_t>(positions.shape(0))};
  if (py::isinstance<py::tuple>(faces) && py::len(faces) == 2) {
    const py::tuple pair = py::reinterpret_borrow<py::tuple>(faces);
    take_corners(pair[1]);
    take_offsets(pair[0]);
  } else {
    take_rows(as_array(faces, "faces"));
  }
}

void MeshArrays::take_corners(const py::handle& corners) {
  const py::array_t<std::uint32_t> indices = as_indices(as_array(corners, "faces"), "faces");
  kept_corners_ = indices;
  corners_ = {indices.data(), static_cast<std::size_t>(indices.size())};
  if (keep_ == Corners::Copied) {
    copied_corners_.assign(corners_.begin(), corners_.end());
    corners_ = copied_corners_;
  }
  const auto outside =
      std::find_if(corners_.begin(), corners_.end(), [&](std::uint32_t v) { return v >= positions_.size(); });
  if (outside != corners_.end())
    throw InvalidInput(place_of(corners, outside - corners_.begin()) + "; vertices are " +
                       (positions_.empty() ? "none" : "0 to " + std::to_string(positions_.size() - 1)));
}

void MeshArrays::take_rows(const py::array& faces) {
  if (faces.ndim() != 2)
    throw InvalidInput("faces: expected integers of the shape (m, k), or a pair of offsets and corners, got " +
                       shape_of(faces));
  take_corners(faces);
  const auto count = static_cast<std::size_t>(faces.shape(0)), size = static_cast<std::size_t>(faces.shape(1));
  if (corners_.size() >= kNone) throw InvalidInput("faces: expected less than 2^32 - 1 corners");
  face_begin_.resize(count + 1);
  for (std::size_t f = 0; f <= count; ++f) face_begin_[f] = static_cast<std::uint32_t>(f * size);
}

void MeshArrays::take_offsets(const py::handle& offsets) {
  const py::array given = as_array(offsets, "faces");
  if (given.ndim() != 1) throw InvalidInput("faces: expected offsets of one dimension, got " + shape_of(given));
  const py::array_t<std::uint32_t> begin = as_indices(given, "faces");
  face_begin_.assign(begin.data(), begin.data() + begin.size());
  if (face_begin_.empty() || face_begin_.front() != 0 || face_begin_.back() != corners_.size() ||
      !std::is_sorted(face_begin_.begin(), face_begin_.end()))
    throw InvalidInput("faces: expected offsets that rise from 0 to the number of corners, " +
                       std::to_string(corners_.size()));
}

py::array owning_array(std::vector<Vec3d> positions) {
  auto owned = std::make_unique<std::vector<Vec3d>>(std::move(positions));
  const auto* data = reinterpret_cast<const double*>(owned->data());
  const auto count = static_cast<py::ssize_t>(owned->size());
  const py::capsule owner(owned.get(), [](void* p) { delete static_cast<std::vector<Vec3d>*>(p); });
  static_cast<void>(owned.release());
  return py::array_t<double>({count, py::ssize_t{3}}, data, owner);
}

py::object faces_of(const Polygons& polygons) {
  const std::size_t count = polygons.face_count(), size = count > 0 ? polygons.face_begin[1] : 3;
  bool is_even = true;
  for (std::size_t f = 0; f <= count; ++f) is_even = is_even && polygons.face_begin[f] == f * size;
  const auto corners = static_cast<py::ssize_t>(polygons.corners.size());
  if (is_even) return owning_array(polygons.corners, {static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(size)});
  return py::make_tuple(owning_array(polygons.face_begin, {static_cast<py::ssize_t>(count) + 1}),
                        owning_array(polygons.corners, {corners}));
}

std::vector<Vec2d> texture_of(const py::object& texture, PolygonView mesh) {
  const py::array given = as_array(texture, "texture");
  const std::size_t pairs = static_cast<std::size_t>(given.size()) / 2, corners = mesh.corners.size();
  const bool are_numbers = is_integral(given) || given.dtype().kind() == 'f',
             are_pairs = given.ndim() >= 2 && given.shape(given.ndim() - 1) == 2,
             of_vertices = given.ndim() == 2 && pairs == mesh.positions.size(),
             of_corners = (given.ndim() == 2 || given.ndim() == 3) && pairs == corners;
  if (!are_numbers || !are_pairs || !(of_vertices || of_corners))
    throw InvalidInput("texture: expected two numbers for each of " + std::to_string(mesh.positions.size()) +
                       " vertices or " + std::to_string(corners) + " corners, got " + shape_of(given) + " of " +
                       std::string(py::str(py::object(given.dtype()))));
  const py::array_t<double, py::array::c_style | py::array::forcecast> numbers(given);
  const auto* const values = reinterpret_cast<const Vec2d*>(numbers.data());
  if (of_vertices) return std::vector<Vec2d>(values, values + pairs);
  const auto is_none = [](const Vec2d& uv) { return std::isnan(uv[0]) || std::isnan(uv[1]); };
  std::vector<Vec2d> of_vertex(mesh.positions.size(), Vec2d(0.0));
  std::vector<std::uint8_t> has_value(of_vertex.size(), 0);
  for (std::size_t c = 0; c < corners; ++c) {
    const std::uint32_t v = mesh.corners[c];
    if (has_value[v]) continue;
    has_value[v] = !is_none(values[c]);
    of_vertex[v] = values[c];
  }
  return of_vertex;
}

std::vector<std::uint8_t> marks_of(const py::object& selection, std::size_t faces) {
  const py::array array = as_array(selection, "only");
  std::vector<std::uint8_t> marks(faces, 0);
  if (array.dtype().kind() == 'b') {
    if (array.ndim() != 1 || static_cast<std::size_t>(array.size()) != faces)
      throw InvalidInput("only: expected a mark for each of " + std::to_string(faces) + " faces, got " +
                         shape_of(array));
    const py::array_t<bool, py::array::c_style | py::array::forcecast> flags(array);
    std::copy_n(flags.data(), faces, marks.begin());
    return marks;
  }
  if (array.ndim() != 1) throw InvalidInput("only: expected marks or numbers of one dimension, got " + shape_of(array));
  const py::array_t<std::uint32_t> numbers = as_indices(array, "only");
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t f = numbers.data()[i];
    if (f >= faces)
      throw InvalidInput("only: expected numbers of faces, from 0 to " + std::to_string(faces) + " - 1, got another");
    marks[f] = 1;
  }
  return marks;
}

}  // namespace vdb_offset::python
