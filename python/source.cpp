// SPDX-License-Identifier: Apache-2.0
#include "source.h"

#include <string>
#include <utility>
#include <vector>

#include "keywords.h"
#include "vdb_offset/run.h"

namespace vdb_offset::python {

Source::Source(Input input, const py::object& vertices, const py::object& faces, const py::dict& keywords,
               MeshArrays::Corners corners)
    : input_(input), arrays_(vertices, faces, corners) {
  bool close = false;
  Keywords(keywords).read("close", close);
  if (close) close_curves();
}

void Source::close_curves() {
  const CurvesView given = arrays_.view();
  Curves curves;
  curves.positions.assign(given.positions.begin(), given.positions.end());
  curves.corners.assign(given.corners.begin(), given.corners.end());
  curves.face_begin.assign(given.face_begin.begin(), given.face_begin.end());
  try {
    if (!vdb_offset::close_curves(curves).empty()) closed_ = std::move(curves);
  } catch (const InvalidInput& error) {
    throw InvalidInput(std::string("close: ") + error.what());
  }
}

}  // namespace vdb_offset::python
