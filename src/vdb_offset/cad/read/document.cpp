// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cad/read/document.h"

#include <Quantity_Color.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <optional>

namespace vdb_offset::cad {
namespace {

using Colour = std::optional<std::array<double, 3>>;

/// What a part, a solid or a face is told to be; what is not told comes from what it is of.
struct Told {
  std::string name, layer;
  Colour colour;
};

std::string utf8(const TCollection_ExtendedString& text) {
  const auto size = static_cast<std::size_t>(text.LengthOfCString());
  std::string result(size + 1, '\0');  // with the zero that is written behind it
  Standard_PCharacter to = result.data();
  text.ToUTF8CString(to);
  result.resize(size);
  return result;
}

std::string name_of(const TDF_Label& label) {
  opencascade::handle<TDataStd_Name> name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? utf8(name->Get()) : std::string();
}

std::string layer_of(const opencascade::handle<TColStd_HSequenceOfExtendedString>& layers) {
  std::string all;
  for (int k = 1; !layers.IsNull() && k <= layers->Length(); ++k) all += (k > 1 ? "; " : "") + utf8(layers->Value(k));
  return all;
}

std::array<double, 3> shown(const Quantity_Color& colour) {
  std::array<double, 3> rgb{};
  colour.Values(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB);
  for (double& part : rgb) part = std::clamp(part, 0.0, 1.0);
  return rgb;
}

/// Walks through a document, from assemblies to faces.
class Walk {
 public:
  Walk(const opencascade::handle<TDocStd_Document>& document, const Names& names, CadModel& model)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        layers_(XCAFDoc_DocumentTool::LayerTool(document->Main())),
        names_(names),
        model_(model) {}

  void walk() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (int k = 1; k <= roots.Length(); ++k) visit(roots.Value(k), TopLoc_Location(), {});
  }

  void count_others(const TopoDS_Shape& shape) {
    for (TopExp_Explorer edge(shape, TopAbs_EDGE, TopAbs_FACE); edge.More(); edge.Next()) ++curves_;
    for (TopExp_Explorer point(shape, TopAbs_VERTEX, TopAbs_EDGE); point.More(); point.Next()) ++points_;
  }

  void add_faces(const TopoDS_Shape& placed, const TDF_Label& part, const Told& told) {
    for (TopExp_Explorer solid(placed, TopAbs_SOLID); solid.More(); solid.Next()) {
      Body body{true, {}};
      const Told own = part.IsNull() ? told : told_of_part_of(solid.Current(), part, told);
      add_faces_of(solid.Current(), TopAbs_SHAPE, part, own, body);
      if (!body.faces.empty()) model_.bodies.push_back(std::move(body));
    }
    add_faces_of(placed, TopAbs_SOLID, part, told, loose_);
    count_others(placed);
  }

  void finish() {
    const auto tell = [&](std::size_t count, const char* one, const char* many) {
      if (count > 0) model_.extras.push_back(std::to_string(count) + " " + (count == 1 ? one : many));
    };
    tell(curves_, "free curve", "free curves");
    tell(points_, "free point", "free points");
    if (repeated_ > 0)
      model_.remarks.push_back(std::to_string(repeated_) +
                               " faces that the file has twice in one place are taken once");
    if (!loose_.faces.empty()) model_.bodies.push_back(std::move(loose_));
  }

 private:
  void visit(const TDF_Label& label, const TopLoc_Location& place, const Told& from_above) {
    TDF_Label shape_label = label;
    TopLoc_Location here = place;
    Told told = told_of(label, from_above);
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      here = place * XCAFDoc_ShapeTool::GetLocation(label);
      XCAFDoc_ShapeTool::GetReferredShape(label, shape_label);
      // A placed part's name is the part's own, where it has one; its colour and layer those of the place.
      const Told of_part = told_of(shape_label, {});
      if (!of_part.name.empty()) told.name = of_part.name;
      if (!told.colour) told.colour = of_part.colour;
      if (told.layer.empty()) told.layer = of_part.layer;
    }
    if (XCAFDoc_ShapeTool::IsAssembly(shape_label)) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(shape_label, components);
      for (int k = 1; k <= components.Length(); ++k) visit(components.Value(k), here, told);
      return;
    }
    TopoDS_Shape shape;
    if (XCAFDoc_ShapeTool::GetShape(shape_label, shape) && !shape.IsNull()) {
      place_ = here;
      add_faces(shape.Located(here * shape.Location()), shape_label, told);
      place_ = TopLoc_Location();
    }
  }

  Colour colour_of(const TDF_Label& label) {
    Quantity_Color colour;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colours_->GetColor(label, type, colour)) return shown(colour);
    return std::nullopt;
  }

  Told told_of(const TDF_Label& label, const Told& otherwise) {
    Told told = otherwise;
    if (const std::string name = name_of(label); !name.empty()) told.name = name;
    if (const Colour colour = colour_of(label)) told.colour = colour;
    opencascade::handle<TColStd_HSequenceOfExtendedString> layers;
    if (layers_->GetLayers(label, layers))
      if (const std::string layer = layer_of(layers); !layer.empty()) told.layer = layer;
    return told;
  }

  /// Of a solid or face of a part, as the document has them without the part's place.
  Told told_of_part_of(const TopoDS_Shape& shape, const TDF_Label& part, const Told& otherwise) {
    TDF_Label label;
    const TopoDS_Shape unplaced = shape.Located(place_.Inverted() * shape.Location());
    Told told = shapes_->FindSubShape(part, unplaced, label) ? told_of(label, otherwise) : otherwise;
    if (const auto name = names_.find(shape.TShape().get()); name != names_.end()) told.name = name->second;
    return told;
  }

  void add_faces_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum not_of, const TDF_Label& part, const Told& told,
                    Body& body) {
    for (TopExp_Explorer face(shape, TopAbs_FACE, not_of); face.More(); face.Next()) {
      if (!seen_.Contains(face.Current()) || body.is_solid) seen_.Add(face.Current());
      else if (++repeated_) continue;
      BodyFace found{TopoDS::Face(face.Current()), {}};
      Told without_name = told;
      without_name.name.clear();
      const Told own = part.IsNull() ? without_name : told_of_part_of(face.Current(), part, without_name);
      found.facts = {own.name, own.layer, own.colour, told.name, {}, {}, {}};
      body.faces.push_back(std::move(found));
    }
  }

  opencascade::handle<XCAFDoc_ShapeTool> shapes_;
  opencascade::handle<XCAFDoc_ColorTool> colours_;
  opencascade::handle<XCAFDoc_LayerTool> layers_;
  const Names& names_;
  CadModel& model_;
  Body loose_;
  TopLoc_Location place_;
  TopTools_IndexedMapOfShape seen_;  // loose faces and those of solids
  std::size_t curves_ = 0, points_ = 0, repeated_ = 0;
};

}  // namespace

opencascade::handle<TDocStd_Document> make_document(double unit_millimetres) {
  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);  // what has no name in the file has none
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  XCAFDoc_DocumentTool::SetLengthUnit(document, unit_millimetres, UnitsMethods_LengthUnit_Millimeter);
  return document;
}

void add_document(const opencascade::handle<TDocStd_Document>& document, const Names& names, CadModel& model) {
  Walk walk(document, names, model);
  walk.walk();
  walk.finish();
}

void add_shape(const TopoDS_Shape& shape, CadModel& model) {
  const Names none;
  Walk walk(make_document(1), none, model);
  walk.add_faces(shape, TDF_Label(), {});
  walk.finish();
}

}  // namespace vdb_offset::cad
