// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "arrays.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::python {

/// What is offset.
enum class Input : bool { Mesh, Curves };

/// A mesh, or curves, as they were handed in; or curves that have been closed.
class Source {
 public:
  /// \param keywords of which `close` counts, for curves
  /// \throw as MeshArrays; InvalidInput if curves are to be closed, and there are open ones but none that can be
  Source(Input input, const py::object& vertices, const py::object& faces, const py::dict& keywords,
         MeshArrays::Corners corners = MeshArrays::Corners::Shared);

  PolygonView view() const { return closed_ ? closed_->view() : arrays_.view(); }
  bool curves() const { return input_ == Input::Curves; }

 private:
  void close_curves();

  Input input_;
  MeshArrays arrays_;
  std::optional<Curves> closed_;
};

}  // namespace vdb_offset::python
