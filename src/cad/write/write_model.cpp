// SPDX-License-Identifier: Apache-2.0
#include "write/write_model.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <TransferBRep_ShapeMapper.hxx>
#include <Transfer_FinderProcess.hxx>
#include <UnitsMethods.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <gp.hxx>
#include <gp_Trsf.hxx>

#include <cmath>
#include <utility>

#include "read/document.h"
#include "write/assemblies.h"

namespace vdb_offset::cad {
namespace {

TCollection_ExtendedString text_of(const std::string& utf8) { return {utf8.c_str(), Standard_True}; }

void fill(const WrittenModel& model, const opencascade::handle<TDocStd_Document>& document) {
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const auto layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
  std::vector<TDF_Label> parts;
  Assemblies assemblies(shapes, model.places);
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    parts.push_back(shapes->AddShape(model.shapes[i], Standard_False));
    TDataStd_Name::Set(parts.back(), text_of(model.names[i].empty() ? "offset" : model.names[i]));
    assemblies.add(parts.back(), model.place_of[i]);
  }
  shapes->UpdateAssemblies();
  for (const auto& [face, facts] : model.faces) {
    TDF_Label label;
    for (const TDF_Label& part : parts)
      if (label.IsNull()) label = shapes->AddSubShape(part, face);
    if (label.IsNull()) continue;
    if (!facts.name.empty()) TDataStd_Name::Set(label, text_of(facts.name));
    if (facts.colour) {
      const auto& [red, green, blue] = *facts.colour;
      colours->SetColor(label, Quantity_Color(red, green, blue, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
    }
    if (!facts.layer.empty()) layers->SetLayer(label, text_of(facts.layer));
  }
}

/// OpenCASCADE's name of a unit; that of millimetres for one that it does not know.
const char* unit_of(double millimetres) {
  constexpr std::pair<double, const char*> kUnits[] = {
      {1e-3, "UM"}, {10, "CM"}, {1000, "M"}, {25.4, "INCH"}, {304.8, "FT"}};
  for (const auto& [length, name] : kUnits)
    if (std::abs(millimetres - length) < 1e-9 * length) return name;
  return "MM";
}

/// The model in the file's own unit: OpenCASCADE names the unit, and writes coordinates as they are.
WrittenModel in_file_unit(const WrittenModel& model) {
  WrittenModel scaled = model;
  if (model.millimetres == 1) return scaled;
  gp_Trsf scale;
  scale.SetScale(gp::Origin(), 1 / model.millimetres);
  for (TopoDS_Shape& shape : scaled.shapes) {
    BRepBuilderAPI_Transform transform(shape, scale, Standard_True);
    TopTools_IndexedMapOfShape faces;
    TopExp::MapShapes(shape, TopAbs_FACE, faces);
    for (std::size_t f = 0; f < model.faces.size(); ++f)
      if (faces.Contains(model.faces[f].first)) scaled.faces[f].first = transform.ModifiedShape(model.faces[f].first);
    shape = transform.Shape();
  }
  return scaled;
}

/// Gives solids the names of their parts: OpenCASCADE takes the name of an instance that lies where its part does for
/// that of the solid.
void name_solids(const WrittenModel& model, const XSControl_WorkSession& session) {
  const auto process = session.TransferWriter()->FinderProcess();
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    opencascade::handle<StepShape_SolidModel> solid;
    const auto mapper = TransferBRep::ShapeMapper(process, model.shapes[i]);
    if (process->FindTypedTransient(mapper, STANDARD_TYPE(StepShape_SolidModel), solid))
      solid->SetName(new TCollection_HAsciiString(model.names[i].c_str()));
  }
}

void write_step(const WrittenModel& model, const std::string& path) {
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  Interface_Static::SetIVal("write.surfacecurve.mode", 1);
  Interface_Static::SetCVal("write.step.unit", unit_of(model.millimetres));
  UnitsMethods::SetCasCadeLengthUnit(1.0);
  const auto document = make_document(1);
  fill(model, document);
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.SetLayerMode(true);
  writer.SetPropsMode(false);
  const bool is_transferred = writer.Transfer(document, STEPControl_AsIs);
  name_solids(model, *writer.Writer().WS());
  if (!is_transferred || writer.Write(path.c_str()) != IFSelect_RetDone)
    throw InvalidCad("expected a model that OpenCASCADE can write as STEP, got one that it cannot");
}

}  // namespace

void write_model(const WrittenModel& model, const std::string& format, const std::string& path) {
  const WrittenModel scaled = in_file_unit(model);
  if (format == "step") return write_step(scaled, path);
  TopoDS_Shape shape = scaled.shapes.front();
  if (scaled.shapes.size() > 1) {
    TopoDS_Compound all;
    BRep_Builder builder;
    builder.MakeCompound(all);
    for (const TopoDS_Shape& each : scaled.shapes) builder.Add(all, each);
    shape = all;
  }
  if (!BRepTools::Write(shape, path.c_str()))
    throw InvalidCad("expected a model that OpenCASCADE can write as BREP, got one that it cannot");
}

}  // namespace vdb_offset::cad
