// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TDocStd_Document.hxx>

#include "vdb_offset/cad/read/cad_model.h"

namespace vdb_offset::cad {

/// An empty document for OpenCASCADE's readers, whose unit is of so many millimetres.
opencascade::handle<TDocStd_Document> make_document(double unit_millimetres);

/// Adds the faces of a document's shapes, each as often as it is placed, with what is told of them.
void add_document(const opencascade::handle<TDocStd_Document>& document, CadModel& model);

/// Adds the faces of a shape of which nothing is told. What has faces, edges and points apart is told in words.
void add_shape(const TopoDS_Shape& shape, CadModel& model);

/// Readers of the formats. \throw InvalidCad
CadModel read_step(const std::string& path);
CadModel read_iges(const std::string& path);
CadModel read_brep(const std::string& path);

}  // namespace vdb_offset::cad
