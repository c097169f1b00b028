// SPDX-License-Identifier: Apache-2.0
// Makes the CAD files that the tests read, by OpenCASCADE: make_models FOLDER. A program of its own, so that the tests
// are not linked to OpenCASCADE, as the library is not.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepFilletAPI_MakeFillet.hxx>
#include <BRepLib.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom_BSplineSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_GraphNode.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <array>
#include <cmath>
#include <fstream>
#include <gp_Ax2.hxx>
#include <gp_Trsf.hxx>
#include <iterator>
#include <string>
#include <vector>

#include "small_models.h"

namespace {

std::string folder;

std::string file(const char* name) { return folder + "/" + name; }

void write_brep(const TopoDS_Shape& shape, const char* name) { BRepTools::Write(shape, file(name).c_str()); }

void write_step(const TopoDS_Shape& shape, const char* name, const char* unit) {
  STEPControl_Writer writer;
  Interface_Static::SetCVal("write.step.unit", unit);
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write(file(name).c_str());
  Interface_Static::SetCVal("write.step.unit", "MM");
}

/// A spline with three spans each way, (40 u, 30 v, 8 u^2 - 6 v^2), less the disc of radius 1/4 around (1/2, 1/2) in
/// (u, v).
TopoDS_Shape patch_with_hole() {
  TColgp_Array2OfPnt poles(1, 3, 1, 3);
  // Bezier points of t^2 over 0 .. 1 are 0, 0, 1.
  for (int i = 1; i <= 3; ++i)
    for (int k = 1; k <= 3; ++k) poles(i, k) = gp_Pnt(20 * (i - 1), 15 * (k - 1), (i == 3 ? 8 : 0) - (k == 3 ? 6 : 0));
  TColStd_Array1OfReal knots(1, 2);
  TColStd_Array1OfInteger multiplicities(1, 2);
  knots(1) = 0, knots(2) = 1;
  multiplicities(1) = multiplicities(2) = 3;
  const Handle(Geom_BSplineSurface) surface =
      new Geom_BSplineSurface(poles, knots, knots, multiplicities, multiplicities, 2, 2);
  for (const double knot : {0.35, 0.6}) surface->InsertUKnot(knot, 1, 0), surface->InsertVKnot(knot, 1, 0);
  // The other way round than the border, as a hole goes.
  const Handle(Geom2d_Circle) circle =
      new Geom2d_Circle(gp_Ax22d(gp_Pnt2d(0.5, 0.5), gp_Dir2d(1, 0), gp_Dir2d(0, -1)), 0.25);
  BRepBuilderAPI_MakeFace face(surface, 1e-7);
  face.Add(BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(circle, surface)).Wire());
  BRepLib::BuildCurves3d(face.Face());
  return face.Face();
}

/// A block of 40 x 30 x 20 with a hole of radius 5, and an upright edge rounded by 4.
TopoDS_Shape block() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(40, 30, 20).Shape();
  BRepFilletAPI_MakeFillet round(box);
  for (TopExp_Explorer edge(box, TopAbs_EDGE); edge.More(); edge.Next()) {
    Standard_Real from = 0, to = 0;
    const auto curve = BRep_Tool::Curve(TopoDS::Edge(edge.Current()), from, to);
    const gp_Pnt middle = curve->Value((from + to) / 2);
    if (middle.Distance(gp_Pnt(0, 0, 10)) < 1e-6) round.Add(4, TopoDS::Edge(edge.Current()));
  }
  const gp_Ax2 axis(gp_Pnt(20, 15, -1), gp_Dir(0, 0, 1));
  return BRepAlgoAPI_Cut(round.Shape(), BRepPrimAPI_MakeCylinder(axis, 5, 22).Shape()).Shape();
}

TopoDS_Shape upright(double x, double y, double z, double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), gp_Dir(0, 0, 1)), radius, height).Shape();
}

/// A plate of 40 x 20 x 5 with two bosses of radius 4 and heights 6 and 8, 1 apart.
TopoDS_Shape bosses() {
  const TopoDS_Shape one = BRepAlgoAPI_Fuse(BRepPrimAPI_MakeBox(40, 20, 5).Shape(), upright(15.5, 10, 5, 4, 6)).Shape();
  return BRepAlgoAPI_Fuse(one, upright(24.5, 10, 5, 4, 8)).Shape();
}

/// The plate with a hole of radius 4 instead, 1 from a side of it.
TopoDS_Shape hole_at_side() {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(40, 20, 5).Shape(), upright(20, 5, -1, 4, 7)).Shape();
}

/// The plate with a hole of radius 2, 1 from a side: in two halves, joined smoothly across from each other.
TopoDS_Shape halves_at_side() {
  const auto half = [](double x) {
    const gp_Ax2 axes(gp_Pnt(20, 3, -1), gp_Dir(0, 0, 1), gp_Dir(x, 0, 0));
    return BRepPrimAPI_MakeCylinder(axes, 2, 7, std::acos(-1.0)).Shape();
  };
  const TopoDS_Shape one = BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(40, 20, 5).Shape(), half(1)).Shape();
  return BRepAlgoAPI_Cut(one, half(-1)).Shape();
}

/// A block of 40 x 30 x 10 with two grooves across each other, 2 and 10 wide, both 4 deep.
TopoDS_Shape grooves() {
  const TopoDS_Shape one =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(40, 30, 10).Shape(), BRepPrimAPI_MakeBox(gp_Pnt(-1, 14, 6), 42, 2, 5).Shape())
          .Shape();
  return BRepAlgoAPI_Cut(one, BRepPrimAPI_MakeBox(gp_Pnt(15, -1, 6), 10, 32, 5).Shape()).Shape();
}

/// The plate with a hole of radius 9 in its middle: two halves that hang together by walls of 1.
TopoDS_Shape waist() {
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(40, 20, 5).Shape(), upright(20, 10, -1, 9, 7)).Shape();
}

/// Two halves of a cone about the z axis, with its tip below, as one: they touch along two lines.
TopoDS_Shape cone_of_halves(double radius, double height) {
  const auto half = [&](double x) {
    const gp_Ax2 axes(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1), gp_Dir(x, 0, 0));
    return BRepPrimAPI_MakeCone(axes, 0, radius, height, std::acos(-1.0)).Shape();
  };
  return BRepAlgoAPI_Fuse(half(1), half(-1)).Shape();
}

/// A block of 20 x 20 x 8.25 with a pit, a cone of splines in two halves. Along a line where these touch, one is
/// trimmed beside it at the tip, where all of its other parameter is one point: as some programs do.
TopoDS_Shape pit() {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(-10, -10, -6), gp_Pnt(10, 10, 2.25)).Shape();
  const TopoDS_Shape cut = BRepAlgoAPI_Cut(box, cone_of_halves(3.75, 2.25)).Shape();
  const TopoDS_Shape all = BRepBuilderAPI_NurbsConvert(cut).Shape();
  BRep_Builder builder;
  for (TopExp_Explorer f(all, TopAbs_FACE); f.More(); f.Next())
    for (TopExp_Explorer e(f.Current(), TopAbs_EDGE); e.More(); e.Next()) {
      const TopoDS_Face face = TopoDS::Face(f.Current());
      const TopoDS_Edge edge = TopoDS::Edge(e.Current());
      const bool starts = BRep_Tool::Pnt(TopExp::FirstVertex(edge)).Distance(gp_Pnt(0, 0, 0)) < 1e-6;
      const bool ends = BRep_Tool::Pnt(TopExp::LastVertex(edge)).Distance(gp_Pnt(0, 0, 0)) < 1e-6;
      if (starts == ends) continue;
      Standard_Real first = 0, last = 0;
      const auto curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
      gp_Pnt2d a = curve->Value(first), b = curve->Value(last);
      const gp_Vec2d aside = std::abs(a.X() - b.X()) < std::abs(a.Y() - b.Y()) ? gp_Vec2d(0.07, 0) : gp_Vec2d(0, 0.07);
      (starts ? a : b).Translate(aside);
      TColgp_Array1OfPnt2d poles(1, 2);
      poles(1) = a;
      poles(2) = b;
      TColStd_Array1OfReal knots(1, 2);
      knots(1) = first;
      knots(2) = last;
      TColStd_Array1OfInteger twice(1, 2);
      twice.Init(2);
      builder.UpdateEdge(edge, new Geom2d_BSplineCurve(poles, knots, twice, 1), face, 0.08);
      builder.UpdateVertex(TopExp::FirstVertex(edge), 0.08);
      builder.UpdateVertex(TopExp::LastVertex(edge), 0.08);
      return all;
    }
  return all;
}

/// A box from one corner to another.
TopoDS_Shape box(const gp_Pnt& low, const gp_Pnt& high) { return BRepPrimAPI_MakeBox(low, high).Shape(); }

/// A block of 40 x 30 x 20 with a cavity: walls of 5 all round.
TopoDS_Shape hollow() { return BRepAlgoAPI_Cut(box({0, 0, 0}, {40, 30, 20}), box({5, 5, 5}, {35, 25, 15})).Shape(); }

/// A tube of radii 10 and 8, and 20 high; a ball of radius 10 with a cavity of radius 8.
TopoDS_Shape tube() { return BRepAlgoAPI_Cut(upright(0, 0, 0, 10, 20), upright(0, 0, -1, 8, 22)).Shape(); }
TopoDS_Shape hollow_ball() { return BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(10), BRepPrimAPI_MakeSphere(8)).Shape(); }

/// A trimming curve that is a line, and misses where it is to begin and to end by these.
Handle(Geom2d_Curve)
    missed(const Handle(Geom2d_Curve) & curve, const std::array<double, 2>& range, const std::array<double, 2>& by) {
  TColgp_Array1OfPnt2d ends(1, 2);
  TColStd_Array1OfReal knots(1, 2);
  TColStd_Array1OfInteger multiplicities(1, 2);
  for (const int k : {0, 1}) {
    ends(k + 1) = curve->Value(range[k]).Translated(gp_Vec2d(by[k], 0));
    knots(k + 1) = range[k];
    multiplicities(k + 1) = 2;
  }
  return new Geom2d_BSplineCurve(ends, knots, multiplicities, 1);
}

/// A cone of radii 12 and 6, and 6 high. The trimming curves of its seam miss those that they meet by a millionth,
/// which is enough for OpenCASCADE to find no triangles.
TopoDS_Shape missed_seam() {
  const TopoDS_Shape cone = BRepPrimAPI_MakeCone(12, 6, 6).Shape();
  for (TopExp_Explorer found(cone, TopAbs_FACE); found.More(); found.Next())
    for (TopExp_Explorer side(found.Current(), TopAbs_EDGE); side.More(); side.Next()) {
      const TopoDS_Face face = TopoDS::Face(found.Current().Oriented(TopAbs_FORWARD));
      const TopoDS_Edge edge = TopoDS::Edge(side.Current().Oriented(TopAbs_FORWARD));
      if (!BRep_Tool::IsClosed(edge, face)) continue;
      std::array<double, 2> range{};
      const auto trim = [&](const TopoDS_Shape& way) {
        return BRep_Tool::CurveOnSurface(TopoDS::Edge(way), face, range[0], range[1]);
      };
      const Handle(Geom2d_Curve) one = trim(edge), other = trim(edge.Reversed());
      constexpr double kTolerance = 1e-4;
      for (TopExp_Explorer end(edge, TopAbs_VERTEX); end.More(); end.Next())
        BRep_Builder().UpdateVertex(TopoDS::Vertex(end.Current()), kTolerance);
      BRep_Builder().UpdateEdge(edge, missed(one, range, {1e-6, 0}), missed(other, range, {1e-6, 0}), face, kTolerance);
      return cone;
    }
  return cone;
}

/// Cylinders on each other: radius and height of each.
TopoDS_Shape turned(const std::vector<std::array<double, 2>>& steps) {
  TopoDS_Shape all;
  double z = 0;
  for (const auto& [radius, height] : steps) {
    const TopoDS_Shape step = upright(0, 0, z, radius, height);
    all = all.IsNull() ? step : BRepAlgoAPI_Fuse(all, step).Shape();
    z += height;
  }
  return all;
}

// What follows is fused of parts whose sides continue each other, and are not made one: edges lie within a plane or a
// cylinder.

/// Two boxes of 10 x 10, 10 and 6 high, side by side.
TopoDS_Shape steps() { return BRepAlgoAPI_Fuse(box({0, 0, 0}, {10, 10, 10}), box({10, 0, 0}, {20, 10, 6})).Shape(); }

/// A box of 20 x 10 x 5 with one of 7 x 10 x 4 on it, 5 from an end.
TopoDS_Shape tee() { return BRepAlgoAPI_Fuse(box({0, 0, 0}, {20, 10, 5}), box({5, 0, 5}, {12, 10, 9})).Shape(); }

/// Four boxes of 10 x 10 around an edge, 10, 8, 4 and 6 high in turn.
TopoDS_Shape towers() {
  const TopoDS_Shape two = BRepAlgoAPI_Fuse(box({0, 0, 0}, {10, 10, 10}), box({10, 0, 0}, {20, 10, 8})).Shape();
  const TopoDS_Shape three = BRepAlgoAPI_Fuse(two, box({10, 10, 0}, {20, 20, 4})).Shape();
  return BRepAlgoAPI_Fuse(three, box({0, 10, 0}, {10, 20, 6})).Shape();
}

/// A cylinder of radius 6 that is 5 high, and 4 more where x is above 0.5.
TopoDS_Shape cut_cylinder() {
  const TopoDS_Shape upper = BRepAlgoAPI_Cut(upright(0, 0, 5, 6, 4), box({-10, -10, 0}, {0.5, 10, 20})).Shape();
  return BRepAlgoAPI_Fuse(upright(0, 0, 0, 6, 5), upper).Shape();
}

TopoDS_Shape curves() {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (int k = 0; k < 3; ++k) builder.Add(all, BRepBuilderAPI_MakeEdge(gp_Pnt(k, 0, 0), gp_Pnt(k, 1, 0)).Edge());
  return all;
}

/// A box without its last face, and one of its faces once more.
TopoDS_Shape open_box() {
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  TopoDS_Shape first;
  int count = 0;
  for (TopExp_Explorer face(BRepPrimAPI_MakeBox(1, 1, 1).Shape(), TopAbs_FACE); face.More() && count < 5; face.Next()) {
    if (count++ == 0) first = face.Current();
    builder.Add(all, face.Current());
  }
  builder.Add(all, first);
  return all;
}

/// A box whose shell looks inward.
TopoDS_Shape inside_out() { return BRepPrimAPI_MakeBox(2, 2, 2).Shape().Reversed(); }

/// A part placed twice: at (100, 0, 0), and turned by a right angle about z.
void write_assembly(const char* name) {
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const auto layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(10, 20, 30).Shape();
  const TDF_Label part = shapes->AddShape(box, Standard_False);
  TDataStd_Name::Set(part, "peg");
  colours->SetColor(part, Quantity_Color(0.25, 0.5, 0.75, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  const TDF_Label face = shapes->AddSubShape(part, TopExp_Explorer(box, TopAbs_FACE).Current());
  TDataStd_Name::Set(face, "front");
  colours->SetColor(face, Quantity_Color(1, 0, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  layers->SetLayer(face, "painted");
  const TDF_Label whole = shapes->NewShape();
  TDataStd_Name::Set(whole, "pair");
  gp_Trsf moved, turned;
  moved.SetTranslation(gp_Vec(100, 0, 0));
  turned.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), std::acos(0.0));
  shapes->AddComponent(whole, part, TopLoc_Location(moved));
  shapes->AddComponent(whole, part, TopLoc_Location(turned));
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.Transfer(document, STEPControl_AsIs);
  writer.Write(file(name).c_str());
}

TDF_Label place(const opencascade::handle<XCAFDoc_ShapeTool>& shapes, const TDF_Label& assembly, const TDF_Label& what,
                double x, double y, const char* name) {
  gp_Trsf moved;
  moved.SetTranslation(gp_Vec(x, y, 0));
  const TDF_Label label = shapes->AddComponent(assembly, what, TopLoc_Location(moved));
  if (name) TDataStd_Name::Set(label, name);
  else label.ForgetAttribute(TDataStd_Name::GetID());
  return label;
}

/// Pins of 2 x 3 x 4: an arm has an upper one, a blue one, a lower one, and one without a name; a robot has a left and
/// a right arm. Of these, the right one's lower pin is green, and called `the cut pin`.
void write_robot(const char* name) {
  opencascade::handle<TDocStd_Document> document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto colours = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(2, 3, 4).Shape();
  const TDF_Label pin = shapes->AddShape(box, Standard_False), arm = shapes->NewShape(), robot = shapes->NewShape();
  TDataStd_Name::Set(pin, "pin");
  TDataStd_Name::Set(arm, "arm");
  TDataStd_Name::Set(robot, "robot");
  colours->SetColor(pin, Quantity_Color(1, 0, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  TDataStd_Name::Set(shapes->AddSubShape(pin, TopExp_Explorer(box, TopAbs_FACE).Current()), "front");
  place(shapes, arm, pin, 0, 0, "upper pin");
  colours->SetColor(place(shapes, arm, pin, 10, 0, "blue pin"), Quantity_Color(0, 0, 1, Quantity_TOC_sRGB),
                    XCAFDoc_ColorSurf);
  const TDF_Label lower = place(shapes, arm, pin, 20, 0, "lower pin");
  place(shapes, arm, pin, 30, 0, nullptr);
  place(shapes, robot, arm, 0, 0, "left arm");
  TDF_LabelSequence right_lower;
  right_lower.Append(place(shapes, robot, arm, 0, 10, "right arm"));
  right_lower.Append(lower);
  shapes->UpdateAssemblies();
  opencascade::handle<XCAFDoc_GraphNode> nested;
  shapes->SetSHUO(right_lower, nested);
  colours->SetColor(nested->Label(), Quantity_Color(0, 1, 0, Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  STEPCAFControl_Writer writer;
  Interface_Static::SetIVal("write.stepcaf.subshapes.name", 1);
  writer.Transfer(document, STEPControl_AsIs);
  writer.Write(file(name).c_str());
  // OpenCASCADE writes no name of what is in one place alone.
  std::ifstream written(file(name));
  std::string text{std::istreambuf_iterator<char>(written), {}};
  const std::string nameless = "SPECIFIED_HIGHER_USAGE_OCCURRENCE('','',";
  text.replace(text.find(nameless), nameless.size(), "SPECIFIED_HIGHER_USAGE_OCCURRENCE('','the cut pin',");
  std::ofstream(file(name)) << text;
}

void write_iges(const TopoDS_Shape& shape, const char* name) {
  IGESControl_Controller::Init();
  IGESControl_Writer writer("IN", 0);  // inches; each face by itself
  writer.AddShape(shape);
  writer.ComputeModel();
  writer.Write(file(name).c_str());
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) return 1;
  folder = words[1];
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  write_step(block(), "block.step", "MM");
  write_step(on_top_of_each_other(block(), 20), "twin_blocks.step", "MM");
  write_brep(BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 10).Shape(), "sphere.brep");
  write_brep(BRepBuilderAPI_NurbsConvert(BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 10).Shape()).Shape(), "spline.brep");
  write_brep(patch_with_hole(), "patch.brep");
  write_brep(BRepPrimAPI_MakeCone(6, 0, 8).Shape(), "cone.brep");
  write_brep(BRepPrimAPI_MakeCone(100, 0, 300).Shape(), "sharp_cone.brep");
  write_brep(BRepPrimAPI_MakeTorus(10, 3).Shape(), "torus.brep");
  // Coordinates are written as they are, whatever the unit.
  write_step(BRepPrimAPI_MakeBox(2, 3, 4).Shape(), "inch.stp", "INCH");
  write_step(BRepPrimAPI_MakeBox(2, 3, 4).Shape(), "metre.step", "M");
  write_step(touching(), "touching.step", "MM");
  write_step(crossed(), "crossed.step", "MM");
  write_step(bosses(), "bosses.step", "MM");
  write_step(hole_at_side(), "hole_at_side.step", "MM");
  write_step(halves_at_side(), "halves_at_side.step", "MM");
  write_step(grooves(), "grooves.step", "MM");
  write_step(waist(), "waist.step", "MM");
  write_step(hollow(), "hollow.step", "MM");
  write_step(tube(), "tube.step", "MM");
  write_step(hollow_ball(), "hollow_ball.step", "MM");
  write_brep(missed_seam(), "missed_seam.brep");
  // Grooves of a width of 1 in a shaft, beside a shoulder and in one radius; a flange; a groove in a bore.
  write_step(turned({{10, 20}, {8, 1}, {9, 19}, {7, 1}, {9, 19}}), "grooved.step", "MM");
  write_step(turned({{5, 10}, {9, 1}, {6, 9}}), "flange.step", "MM");
  write_step(BRepAlgoAPI_Cut(turned({{20, 30}}), turned({{5, 10}, {7, 1}, {5, 19}})).Shape(), "bore.step", "MM");
  write_step(steps(), "steps.step", "MM");
  write_step(tee(), "tee.step", "MM");
  write_step(towers(), "towers.step", "MM");
  write_step(cut_cylinder(), "cut_cylinder.step", "MM");
  write_brep(pit(), "pit.brep");
  write_step(curves(), "curves.step", "MM");
  write_brep(open_box(), "open.brep");
  write_brep(inside_out(), "inside_out.brep");
  write_step(rounded_block(), "rounded_block.step", "MM");
  write_step(dumbbell(), "dumbbell.step", "MM");
  write_step(pyramid(), "pyramid.step", "MM");
  write_step(block_and_plate(), "block_and_plate.step", "MM");
  write_iges(turned_cube(), "turned_cube.igs");
  write_iges(BRepPrimAPI_MakeBox(25.4, 2 * 25.4, 3 * 25.4).Shape(), "faces.igs");
  write_assembly("assembly.step");
  write_robot("robot.step");
  return 0;
}
