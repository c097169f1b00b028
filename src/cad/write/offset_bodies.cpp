// SPDX-License-Identifier: Apache-2.0
#include "write/offset_bodies.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp.hxx>
#include <gp_Trsf.hxx>
#include <optional>

#include "ground/process/progress.h"
#include "hold/hold_back.h"
#include "write/face_distances.h"

namespace vdb_offset::cad {
namespace {

class BodiesHolder {
 public:
  BodiesHolder(std::vector<OffsetBody>& bodies, const Asked& asked) : bodies_(bodies), asked_(asked) {}

  HeldBodies run() {
    constexpr int kMostRounds = 4;
    HoldRequest request;
    request.source = together(bodies_, [](const OffsetBody& each) { return each.source.shape; });
    for (const OffsetBody& each : bodies_)
      for (std::size_t k = 0; k < each.body.faces.size(); ++k)
        request.distances.push_back(each.is_even() ? FaceDistance{asked_.millimetres * asked_.write.distance, {}, 0}
                                                   : each.distances[k]);
    request.largest = asked_.largest();
    std::optional<Soup> obstacles;
    if (!asked_.write.obstacle_triangles.empty())
      request.obstacles = &obstacles.emplace(obstacle_points(asked_), asked_.write.obstacle_triangles);
    request.clearance = asked_.millimetres * asked_.write.clearance;
    HoldBack hold(request);
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<FaceDistance> distances = hold.distances();
      made_.held = hold.held();
      made_.least_held = hold.least_share();
      auto next = distances.begin();
      for (OffsetBody& each : bodies_) {
        const auto end = next + static_cast<std::ptrdiff_t>(each.body.faces.size());
        if (hold.held() > 0 || !each.is_even()) each.distances.assign(next, end);
        next = end;
      }
      {  // nobody knows how many rounds there will be: each is shown as half of what is left
        const double left = std::pow(0.5, round);
        const ProgressPart part(1 - left, 1 - left / 2);
        made_.results.clear();
        for (const OffsetBody& each : bodies_) made_.results.push_back(offset_cad(request_of(each, asked_)));
      }
      if (!hold.add(crossing_faces())) break;
    }
    return std::move(made_);
  }

 private:
  /// The faces of the source, counted over all bodies, whose offsets cross.
  std::vector<std::array<int, 2>> crossing_faces() const {
    TopTools_DataMapOfShapeInteger numbers;  // of the source's faces, by those made of them
    int first = 0;
    for (const OffsetCadResult& each : made_.results) {
      if (each.shape.IsNull()) return {};
      for (std::size_t k = 0; k < each.made_of.size(); ++k)
        if (!each.made_of[k].IsNull()) numbers.Bind(each.made_of[k], first + static_cast<int>(k));
      first += static_cast<int>(each.faces.size());
    }
    const TopoDS_Shape all = together(made_.results, [](const OffsetCadResult& each) { return each.shape; });
    std::vector<int> sources;
    for (TopExp_Explorer face(all, TopAbs_FACE); face.More(); face.Next())
      sources.push_back(numbers.IsBound(face.Current()) ? numbers.Find(face.Current()) : -1);
    std::vector<std::array<int, 2>> pairs;
    for (const auto& [a, b] : Soup::of_result(all, asked_.largest()).crossing_faces()) {
      const int one = sources[static_cast<std::size_t>(a)], other = sources[static_cast<std::size_t>(b)];
      if (one >= 0 && other >= 0) pairs.push_back({std::min(one, other), std::max(one, other)});
    }
    return pairs;
  }

  std::vector<OffsetBody>& bodies_;
  const Asked& asked_;
  HeldBodies made_;
};

}  // namespace

std::optional<double> OffsetBody::distance_of_moved() const {
  std::optional<double> one;
  for (std::size_t k = 0; k < distances.size(); ++k) {
    if (stays(k)) continue;
    if (distances[k].at || (one && *one != distances[k].constant)) return std::nullopt;
    one = distances[k].constant;
  }
  return one;
}

TopoDS_Shape OffsetBody::faces_that(bool stay) const {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  std::size_t k = 0;
  for (TopExp_Explorer face(source.shape, TopAbs_FACE); face.More(); face.Next(), ++k)
    if (stays(k) == stay) builder.Add(all, face.Current());
  return all;
}

TopoDS_Shape scaled(const TopoDS_Shape& shape, double factor) {
  if (factor == 1 || shape.IsNull()) return shape;
  gp_Trsf scale;
  scale.SetScale(gp::Origin(), factor);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

std::vector<gp_Pnt> obstacle_points(const Asked& asked) {
  std::vector<gp_Pnt> points;
  points.reserve(asked.write.obstacle_positions.size());
  for (const Vec3d& at : asked.write.obstacle_positions)
    points.emplace_back(asked.millimetres * at.x(), asked.millimetres * at.y(), asked.millimetres * at.z());
  return points;
}

std::vector<OffsetBody> bodies_of(const CadModel& model, const std::vector<BodyMesh>& meshes, const Asked& asked) {
  std::vector<OffsetBody> bodies;
  bodies.reserve(model.bodies.size());
  std::size_t first_face = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    bodies.push_back({model.bodies[b], meshes[b], shape_of(model.bodies[b]), {}});
    OffsetBody& each = bodies.back();
    each.source.shape = scaled(each.source.shape, asked.millimetres);
    if (!asked.write.is_even()) each.distances = distances_of(asked.write, first_face, each.source, asked.millimetres);
    first_face += each.body.faces.size();
  }
  return bodies;
}

OffsetCadRequest request_of(const OffsetBody& body, const Asked& asked) {
  OffsetCadRequest request;
  request.source = body.source.shape;
  request.distance = body.is_even() ? asked.millimetres * asked.write.distance : asked.largest();
  request.fit_tolerance = asked.millimetres * asked.write.fit_tolerance;
  request.of_face = body.distances;
  return request;
}

HeldBodies hold_bodies(std::vector<OffsetBody>& bodies, const Asked& asked) {
  return BodiesHolder(bodies, asked).run();
}

}  // namespace vdb_offset::cad
