// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TDocStd_Document.hxx>
#include <TopoDS_TShape.hxx>
#include <string>
#include <unordered_map>

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// An empty document for OpenCASCADE's readers, whose unit is of so many millimetres.
opencascade::handle<TDocStd_Document> make_document(double unit_millimetres);

/// Names of solids and faces, by what their shapes have in common wherever they are placed.
using Names = std::unordered_map<const TopoDS_TShape*, std::string>;

/// Adds the faces of a document's shapes, each as often as it is placed, with what is told of them. `names` are those
/// that the document does not have.
void add_document(const opencascade::handle<TDocStd_Document>& document, const Names& names, CadModel& model);

/// Adds the faces of a shape without labels. What has faces, edges and points apart is reported in words.
void add_shape(const TopoDS_Shape& shape, CadModel& model);

/// Readers of the formats. \throw InvalidCad
CadModel read_step(const std::string& path);
CadModel read_iges(const std::string& path);
CadModel read_brep(const std::string& path);

}  // namespace vdb_offset::cad
