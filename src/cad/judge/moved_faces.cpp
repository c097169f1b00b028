// SPDX-License-Identifier: Apache-2.0
#include "judge/moved_faces.h"

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <map>

#include "ground/mesh/point_triangle.h"
#include "judge/soup.h"
#include "judge/soup_samples.h"

namespace vdb_offset::cad {
namespace {

constexpr double kLeast = 0.99;  // of a distance
constexpr double kOff = 0.002;   // of the largest, as far as triangles are from the source

gp_Pnt foot_of(const gp_Pnt& point, const Soup::Triangle& triangle) {
  const auto vector = [](const gp_Pnt& p) { return Vec3d(p.X(), p.Y(), p.Z()); };
  const auto& [a, b, c] = triangle.points;
  const Vec3d foot = closest_on_triangle(vector(point), vector(a), vector(b), vector(c)).point;
  return {foot.x(), foot.y(), foot.z()};
}

class MovedFaces {
 public:
  MovedFaces(const std::vector<MovedFace>& faces, double largest)
      : faces_(faces), largest_(largest), source_(source_of(faces), kOff * largest, kOff * largest, 0.25) {
    for (std::size_t k = 0; k < faces.size(); ++k)
      marks_.try_emplace(faces[k].distance, faces.size(), 0).first->second[k] = 1;
  }

  std::optional<TooNear> first() {
    // Each point is held against every distance: of many, fewer points.
    constexpr std::size_t kMostSamples = 10000, kMostQueries = 40000;
    BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    std::vector<double> own;  // of each made face
    for (const MovedFace& face : faces_)
      for (const TopoDS_Face& made : face.made) {
        if (face.distance <= 0 || made.IsNull()) continue;
        builder.Add(all, made);
        own.push_back(face.distance);
      }
    if (own.empty()) return std::nullopt;
    const Soup moved = Soup::of_result(all, largest_);
    for (const SoupPoint& at : spread(moved, static_cast<int>(std::min(kMostSamples, kMostQueries / marks_.size()))))
      if (const auto near = too_near(at.point, own[static_cast<std::size_t>(moved.triangles()[at.triangle].face)]))
        return near;
    return std::nullopt;
  }

 private:
  static TopoDS_Compound source_of(const std::vector<MovedFace>& faces) {
    BRep_Builder builder;
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (const MovedFace& face : faces) builder.Add(all, face.source);
    return all;
  }

  std::optional<TooNear> too_near(const gp_Pnt& point, double own) const {
    for (const auto& [distance, of] : marks_) {
      if (distance <= 0) continue;
      const double asked = std::min(distance, own);
      const Soup::Nearest nearest = source_.nearest(point, kLeast * asked, {&of, {}});
      if (nearest.triangle < 0 || is_at_one_that_stays(foot_of(point, source_.triangles()[nearest.triangle]))) continue;
      return TooNear{point, nearest.distance, asked};
    }
    return std::nullopt;
  }

  bool is_at_one_that_stays(const gp_Pnt& foot) const {
    const auto staying = marks_.find(0);
    return staying != marks_.end() && source_.nearest(foot, 5 * kOff * largest_, {&staying->second, {}}).triangle >= 0;
  }

  const std::vector<MovedFace>& faces_;
  double largest_;
  Soup source_;
  std::map<double, std::vector<char>> marks_;  // by how far they go: 1 for these faces
};

}  // namespace

std::optional<TooNear> nearer_than_asked(const std::vector<MovedFace>& faces, double largest) {
  return MovedFaces(faces, largest).first();
}

}  // namespace vdb_offset::cad
