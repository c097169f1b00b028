// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cad/write/write_model.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Compound.hxx>
#include <UnitsMethods.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp.hxx>
#include <gp_Trsf.hxx>

#include "vdb_offset/cad/read/cad_model.h"
#include "vdb_offset/cad/read/document.h"

namespace vdb_offset::cad {
namespace {

TCollection_ExtendedString text_of(const std::string& utf8) { return {utf8.c_str(), Standard_True}; }

void fill(const WrittenModel& model, const opencascade::handle<TDocStd_Document>& document) {
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const auto layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
  std::vector<TDF_Label> parts;
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    parts.push_back(shapes->AddShape(model.shapes[i], Standard_False));
    TDataStd_Name::Set(parts.back(), text_of(model.names[i].empty() ? "offset" : model.names[i]));
  }
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

void write_step(const WrittenModel& model, const std::string& path) {
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  Interface_Static::SetIVal("write.surfacecurve.mode", 1);
  UnitsMethods::SetCasCadeLengthUnit(1.0);
  const auto document = make_document(1);
  fill(model, document);
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  writer.SetLayerMode(true);
  writer.SetPropsMode(false);
  if (!writer.Transfer(document, STEPControl_AsIs) || writer.Write(path.c_str()) != IFSelect_RetDone)
    throw InvalidCad("expected a model that OpenCASCADE can write as STEP, got one that it cannot");
}

}  // namespace

void write_model(const WrittenModel& model, const std::string& format, const std::string& path) {
  if (format == "step") return write_step(model, path);
  TopoDS_Shape shape = model.shapes.front();
  if (model.shapes.size() > 1) {
    TopoDS_Compound all;
    BRep_Builder builder;
    builder.MakeCompound(all);
    for (const TopoDS_Shape& each : model.shapes) builder.Add(all, each);
    shape = all;
  }
  if (model.millimetres != 1) {
    gp_Trsf scale;
    scale.SetScale(gp::Origin(), 1 / model.millimetres);
    shape = BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
  }
  if (!BRepTools::Write(shape, path.c_str()))
    throw InvalidCad("expected a model that OpenCASCADE can write as BREP, got one that it cannot");
}

}  // namespace vdb_offset::cad
