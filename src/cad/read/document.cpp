// SPDX-License-Identifier: Apache-2.0
#include "read/document.h"

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
#include <XCAFDoc_GraphNode.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <optional>

#include "read/poles.h"

namespace vdb_offset::cad {
namespace {

using Colour = std::optional<std::array<double, 3>>;

/// What a part, a solid or a face is by its labels; what they leave out comes from what it is of.
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
    for (int k = 1; k <= roots.Length(); ++k) visit(roots.Value(k), TopLoc_Location(), {}, {});
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
  void visit(const TDF_Label& label, const TopLoc_Location& location, const Told& from_above,
             std::optional<std::size_t> above) {
    TDF_Label shape_label = label;
    TopLoc_Location here = location;
    Told told = told_of(label, from_above);
    Place place{above, {}, {}, {}, false};
    const bool is_instance = XCAFDoc_ShapeTool::IsReference(label);
    if (is_instance) {
      here = location * XCAFDoc_ShapeTool::GetLocation(label);
      XCAFDoc_ShapeTool::GetReferredShape(label, shape_label);
      path_.push_back(label);
      place.instance = name_of(label);
      take_nested(place, told);
      // A placed part's name is the part's own, where it has one; its colour and layer those of the place.
      const Told of_part = told_of(shape_label, {});
      if (!of_part.name.empty()) told.name = of_part.name;
      if (!told.colour) told.colour = of_part.colour;
      if (told.layer.empty()) told.layer = of_part.layer;
    }
    place.product = name_of(shape_label);
    place.is_assembly = XCAFDoc_ShapeTool::IsAssembly(shape_label);
    model_.places.push_back(std::move(place));
    visit_shape(shape_label, here, told);
    if (is_instance) path_.pop_back();
  }

  /// Visits what is at the last of the places.
  void visit_shape(const TDF_Label& label, const TopLoc_Location& location, const Told& told) {
    place_ = model_.places.size() - 1;
    if (model_.places.back().is_assembly) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(label, components);
      const std::size_t assembly = *place_;
      for (int k = 1; k <= components.Length(); ++k) visit(components.Value(k), location, told, assembly);
      return;
    }
    TopoDS_Shape shape;
    if (XCAFDoc_ShapeTool::GetShape(label, shape) && !shape.IsNull()) {
      location_ = location;
      add_faces(closed_at_poles(shape.Located(location * shape.Location())), label, told);
      location_ = TopLoc_Location();
    }
  }

  /// What is told of the last of the placed parts and assemblies as long as it is in those before it. (XCAF calls that
  /// a specified higher usage occurrence.) What begins farther up says more of the one place that is meant.
  void take_nested(Place& place, Told& told) {
    for (std::size_t first = path_.size() - 1; first-- > 0;) {
      TDF_LabelSequence labels;
      for (std::size_t k = first; k < path_.size(); ++k) labels.Append(path_[k]);
      opencascade::handle<XCAFDoc_GraphNode> nested;
      if (!XCAFDoc_ShapeTool::FindSHUO(labels, nested) || nested.IsNull()) continue;
      const Told of_nested = told_of(nested->Label(), {});
      if (of_nested.colour) told.colour = of_nested.colour;
      if (of_nested.name.empty()) continue;
      if (place.usual.empty()) place.usual = place.instance;
      place.instance = of_nested.name;
    }
  }

  /// The names of all that a face is in, and of the innermost place that has one.
  void name_places(io::CadFaceFacts& facts) const {
    for (std::optional<std::size_t> at = place_; at; at = model_.places[*at].above) {
      const Place& place = model_.places[*at];
      for (const std::string& name : {place.product, place.usual, place.instance})
        if (!name.empty()) facts.within.push_back(name);
      if (facts.instance.empty()) facts.instance = place.instance;
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
    const TopoDS_Shape unplaced = shape.Located(location_.Inverted() * shape.Location());
    Told told = shapes_->FindSubShape(part, unplaced, label) ? told_of(label, otherwise) : otherwise;
    if (const auto name = names_.find(shape.TShape().get()); name != names_.end()) told.name = name->second;
    return told;
  }

  void add_faces_of(const TopoDS_Shape& shape, TopAbs_ShapeEnum not_of, const TDF_Label& part, const Told& told,
                    Body& body) {
    for (TopExp_Explorer face(shape, TopAbs_FACE, not_of); face.More(); face.Next()) {
      if (!seen_.Contains(face.Current()) || body.is_solid) seen_.Add(face.Current());
      else if (++repeated_) continue;
      BodyFace found{TopoDS::Face(face.Current()), {}, place_};
      Told without_name = told;
      without_name.name.clear();
      const Told own = part.IsNull() ? without_name : told_of_part_of(face.Current(), part, without_name);
      found.facts = {own.name, own.layer, own.colour, told.name, {}, {}, {}, {}, {}};
      name_places(found.facts);
      body.faces.push_back(std::move(found));
    }
  }

  opencascade::handle<XCAFDoc_ShapeTool> shapes_;
  opencascade::handle<XCAFDoc_ColorTool> colours_;
  opencascade::handle<XCAFDoc_LayerTool> layers_;
  const Names& names_;
  CadModel& model_;
  Body loose_;
  TopLoc_Location location_;          // of the part at hand
  std::optional<std::size_t> place_;  // of the part at hand
  std::vector<TDF_Label> path_;       // the instances that lead to it
  TopTools_IndexedMapOfShape seen_;   // loose faces and those of solids
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
