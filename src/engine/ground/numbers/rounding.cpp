// SPDX-License-Identifier: Apache-2.0
#include "ground/numbers/rounding.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

namespace vdb_offset {

namespace {

Vec3d unit_or_none(const Vec3d& n) {
  const double length = n.length();
  return length > 0 && std::isfinite(length) ? n / length : Vec3d(0.0);
}

bool is_finite(const std::array<Vec3d, 3>& columns) {
  return std::all_of(columns.begin(), columns.end(), [](const Vec3d& column) { return column.isFinite(); });
}

}  // namespace

std::optional<AffineFrame> AffineFrame::of(const std::array<Vec3d, 3>& axes, const Vec3d& origin) {
  AffineFrame frame;
  if (axes == frame.axes_ && origin == frame.origin_) return frame;
  const double determinant = axes[0].dot(axes[1].cross(axes[2]));
  if (!is_finite(axes) || !origin.isFinite() || !std::isnormal(determinant)) return std::nullopt;
  const Vec3d rows[3] = {axes[1].cross(axes[2]) / determinant, axes[2].cross(axes[0]) / determinant,
                         axes[0].cross(axes[1]) / determinant};
  frame.axes_ = axes;
  frame.origin_ = origin;
  for (int k = 0; k < 3; ++k) frame.inverse_[k] = Vec3d(rows[0][k], rows[1][k], rows[2][k]);
  if (!is_finite(frame.inverse_)) return std::nullopt;
  frame.identity_ = false;
  frame.mirrors_ = determinant < 0;
  return frame;
}

Vec3d AffineFrame::normal_to_mesh(const Vec3d& n) const {
  return identity_ ? n : unit_or_none({inverse_[0].dot(n), inverse_[1].dot(n), inverse_[2].dot(n)});
}

Vec3d AffineFrame::normal_to_file(const Vec3d& n) const {
  return identity_ ? n : unit_or_none({axes_[0].dot(n), axes_[1].dot(n), axes_[2].dot(n)});
}

double AffineFrame::reach(const Vec3d& q) const {
  double most = 0;
  for (int k = 0; k < 3; ++k) {
    double sum = std::abs(origin_[k]);
    for (int j = 0; j < 3; ++j) sum += std::abs(axes_[j][k] * q[j]);
    most = std::max(most, sum);
  }
  return most;
}

FileFrames::FileFrames(std::span<const AffineFrame> frames, std::span<const std::uint32_t> first,
                       std::span<const Vec3d> positions) {
  const bool several = std::any_of(frames.begin(), frames.end(), [&](const auto& f) { return !(f == frames[0]); });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto own = static_cast<std::uint32_t>(sets_.size());
    sets_.push_back({frames[i]});
    for (std::uint32_t v = first[i]; v < first[i + 1]; ++v) {
      extent_ = std::max(extent_, frames[i].reach(frames[i].to_file(positions[v])));
      if (!several) continue;
      const auto [known, is_new] = at_.try_emplace(positions[v], own);
      if (!is_new) known->second = joined(known->second, own);
    }
  }
}

/// The set with the frame of another, of one frame, unless that is in it.
std::uint32_t FileFrames::joined(std::uint32_t set, std::uint32_t other) {
  const AffineFrame& frame = sets_[other].front();
  if (sets_[set].size() >= kMostTogether || std::find(sets_[set].begin(), sets_[set].end(), frame) != sets_[set].end())
    return set;
  const auto [known, is_new] = joined_.try_emplace({set, other}, static_cast<std::uint32_t>(sets_.size()));
  if (is_new) {
    std::vector<AffineFrame> larger = sets_[set];
    larger.push_back(frame);
    sets_.push_back(std::move(larger));
  }
  return known->second;
}

std::span<const AffineFrame> FileFrames::find(const Vec3d& position) const {
  if (at_.empty()) return sets_.front();
  const auto known = at_.find(position);
  if (known == at_.end()) return {};
  return sets_[known->second];
}

Vec3d FileFrames::as_kept(const Vec3d& source, Vec3d position, const std::function<Vec3d(const Vec3d&)>& kept) const {
  // Two are enough but for frames that are far from their vertices, or apart by numbers that not all of them can hold.
  constexpr int kMostRounds = 16;
  const std::span<const AffineFrame> frames = find(source);
  for (int round = 0; round < kMostRounds; ++round) {
    const Vec3d before = position;
    for (const AffineFrame& frame : frames) position = frame.to_mesh(kept(frame.to_file(position)));
    if (position == before) break;
  }
  return position;
}

std::size_t FileFrames::Hash::operator()(const Vec3d& p) const {
  const std::hash<double> hash;
  return (hash(p[0]) * 31 + hash(p[1])) * 31 + hash(p[2]);
}

double Rounding::rounded_to_digits(double value) const {
  char text[40];
  const auto end = std::to_chars(std::begin(text), std::end(text), value, std::chars_format::general, digits).ptr;
  double rounded = value;
  std::from_chars(text, end, rounded);
  return rounded;
}

}  // namespace vdb_offset
