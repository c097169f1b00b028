// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/step_files.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Reader.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_Face.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <stdexcept>

namespace cad_proof {

void write_step(const TopoDS_Shape& shape, const std::string& path) {
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const TDF_Label part = shapes->AddShape(shape, Standard_False);
  TDataStd_Name::Set(part, "part");
  int number = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
    TDataStd_Name::Set(shapes->AddSubShape(part, face.Current()), ("f" + std::to_string(++number)).c_str());
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  if (!writer.Transfer(document, STEPControl_AsIs) || writer.Write(path.c_str()) != IFSelect_RetDone)
    throw std::runtime_error("OpenCASCADE does not write " + path);
}

StepFile read_step(const std::string& path) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("OpenCASCADE does not read " + path);
  reader.TransferRoots();
  StepFile file{reader.OneShape(), {}};
  const auto process = reader.WS()->TransferReader()->TransientProcess();
  const auto entities = reader.WS()->Model();
  std::map<const void*, std::string> names;
  for (int k = 1; k <= entities->NbEntities(); ++k) {
    const auto face = opencascade::handle<StepShape_Face>::DownCast(entities->Value(k));
    if (face.IsNull() || face->Name().IsNull()) continue;
    const TopoDS_Shape made = TransferBRep::ShapeResult(process, face);
    if (!made.IsNull()) names[made.TShape().get()] = face->Name()->ToCString();
  }
  // As they lie in the shape, which knows which way they are turned.
  for (TopExp_Explorer face(file.shape, TopAbs_FACE); face.More(); face.Next())
    if (const auto name = names.find(face.Current().TShape().get()); name != names.end() && !name->second.empty())
      file.faces.emplace(name->second, TopoDS::Face(face.Current()));
  return file;
}

double diagonal_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, Standard_False, Standard_False);
  return std::sqrt(box.SquareExtent());
}

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

}  // namespace cad_proof
