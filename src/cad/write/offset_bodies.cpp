// SPDX-License-Identifier: Apache-2.0
#include "write/offset_bodies.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp.hxx>
#include <gp_Trsf.hxx>
#include <optional>
#include <utility>

#include "ground/process/progress.h"
#include "hold/hold_back.h"
#include "vdb_offset/run.h"
#include "write/face_distances.h"

namespace vdb_offset::cad {
namespace {

class BodiesMaker {
 public:
  BodiesMaker(const io::WriteCad& write, double millimetres, bool keeps_turned)
      : write_(write), millimetres_(millimetres), keeps_turned_(keeps_turned) {}

  OffsetBodies run(const CadModel& model) {
    for (const Body& body : model.bodies) {
      bodies_.push_back({body, shape_of(body), {}, {}});
      bodies_.back().source.shape = scaled(bodies_.back().source.shape, millimetres_);
    }
    try {
      take_distances();
      if (write_.held) make_held();
      else make_bodies();
    } catch (const Error& error) {
      made_.gaps.emplace_back(error.what());
    }
    return std::move(made_);
  }

 private:
  double largest() const { return millimetres_ * std::abs(write_.distance); }

  void take_distances() {
    if (write_.is_even()) return;
    std::size_t first_face = 0;
    for (OffsetBody& each : bodies_) {
      each.distances = distances_of(write_, first_face, each.source, millimetres_);
      first_face += each.body.faces.size();
    }
  }

  void make_bodies() {
    const auto count = static_cast<double>(bodies_.size());
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const ProgressPart part(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
      OffsetBody& each = bodies_[i];
      OffsetCadRequest request;
      request.keeps_turned = keeps_turned_ && each.body.is_solid;
      request.source = each.source.shape;
      request.distance = each.is_even() ? millimetres_ * write_.distance : largest();
      request.fit_tolerance = millimetres_ * write_.fit_tolerance;
      request.of_face = each.distances;
      try {
        each.result = offset_cad(request);
      } catch (const Standard_Failure& failure) {
        each.result = {};
        each.result.gaps.push_back(std::string("OpenCASCADE fails: ") + failure.DynamicType()->Name());
      }
    }
  }

  /// Makes the bodies with their faces held back, first where fronts come towards each other, then where faces of the
  /// result cross as well.
  void make_held() {
    constexpr int kMostRounds = 4;
    HoldRequest request;
    request.source = together(bodies_, [](const OffsetBody& each) { return each.source.shape; });
    for (const OffsetBody& each : bodies_)
      for (std::size_t k = 0; k < each.body.faces.size(); ++k)
        request.distances.push_back(each.is_even() ? FaceDistance{millimetres_ * write_.distance, {}, 0}
                                                   : each.distances[k]);
    request.largest = largest();
    std::optional<Soup> obstacles;
    if (!write_.obstacle_triangles.empty()) request.obstacles = &obstacles.emplace(obstacle_soup(write_, millimetres_));
    request.clearance = millimetres_ * write_.clearance;
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
        make_bodies();
      }
      if (!hold.add(crossing_faces())) break;
    }
  }

  /// The faces of the source, counted over all bodies, whose offsets cross.
  std::vector<std::array<int, 2>> crossing_faces() const {
    TopTools_DataMapOfShapeInteger numbers;  // of the source's faces, by those made of them
    int first = 0;
    for (const OffsetBody& each : bodies_) {
      if (each.result.shape.IsNull()) return {};
      for (std::size_t k = 0; k < each.result.made_of.size(); ++k)
        if (!each.result.made_of[k].IsNull()) numbers.Bind(each.result.made_of[k], first + static_cast<int>(k));
      first += static_cast<int>(each.body.faces.size());
    }
    const TopoDS_Shape all = together(bodies_, [](const OffsetBody& each) { return each.result.shape; });
    std::vector<int> sources;
    for (TopExp_Explorer face(all, TopAbs_FACE); face.More(); face.Next())
      sources.push_back(numbers.IsBound(face.Current()) ? numbers.Find(face.Current()) : -1);
    std::vector<std::array<int, 2>> pairs;
    for (const auto& [a, b] : result_soup(all, largest()).crossing_faces()) {
      const int one = sources[static_cast<std::size_t>(a)], other = sources[static_cast<std::size_t>(b)];
      if (one >= 0 && other >= 0) pairs.push_back({std::min(one, other), std::max(one, other)});
    }
    return pairs;
  }

  const io::WriteCad& write_;
  const double millimetres_;
  const bool keeps_turned_;
  OffsetBodies made_;
  std::vector<OffsetBody>& bodies_ = made_.all;
};

}  // namespace

TopoDS_Shape scaled(const TopoDS_Shape& shape, double factor) {
  if (factor == 1 || shape.IsNull()) return shape;
  gp_Trsf scale;
  scale.SetScale(gp::Origin(), factor);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

Soup result_soup(const TopoDS_Shape& shape, double distance) {
  constexpr double kAngle = 0.3;  // between normals at neighbouring corners, in radians
  return {shape, 0.01 * distance, 0.02 * distance, kAngle};
}

std::vector<gp_Pnt> obstacle_points(const io::WriteCad& write, double millimetres) {
  std::vector<gp_Pnt> points;
  for (const Vec3d& at : write.obstacle_positions)
    points.emplace_back(millimetres * at.x(), millimetres * at.y(), millimetres * at.z());
  return points;
}

Soup obstacle_soup(const io::WriteCad& write, double millimetres) {
  return {obstacle_points(write, millimetres), write.obstacle_triangles};
}

OffsetBodies offset_bodies(const CadModel& model, const io::WriteCad& write, double millimetres, bool keeps_turned) {
  return BodiesMaker(write, millimetres, keeps_turned).run(model);
}

}  // namespace vdb_offset::cad
