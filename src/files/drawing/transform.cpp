// SPDX-License-Identifier: Apache-2.0
// Transforms of SVG: their arithmetic, and reading them from attributes.
#include "drawing/transform.h"

#include <algorithm>
#include <initializer_list>
#include <vector>

namespace vdb_offset::io {
namespace {

constexpr double kDegree = 0.017453292519943295;  // in radians

double determinant(const SvgMatrix& m) { return m[0] * m[3] - m[1] * m[2]; }

SvgMatrix parse_function(SvgValueScanner& value, std::string_view name) {
  std::vector<double> n;
  while (!value.close()) n.push_back(value.number("a number or ')' in a transform"));
  const auto given = [&](std::initializer_list<std::size_t> counts) {
    return std::find(counts.begin(), counts.end(), n.size()) != counts.end();
  };
  if (name == "matrix" && given({6})) return {n[0], n[1], n[2], n[3], n[4], n[5]};
  if (name == "translate" && given({1, 2})) return {1, 0, 0, 1, n[0], n.size() > 1 ? n[1] : 0};
  if (name == "scale" && given({1, 2})) return {n[0], 0, 0, n.back(), 0, 0};
  if (name == "skewX" && given({1})) return {1, 0, std::tan(n[0] * kDegree), 1, 0, 0};
  if (name == "skewY" && given({1})) return {1, std::tan(n[0] * kDegree), 0, 1, 0, 0};
  if (name != "rotate" || !given({1, 3}))
    value.fail(fmt::format("a transform that SVG knows, not '{}' of {} numbers, before here", name, n.size()));
  const double c = std::cos(n[0] * kDegree), s = std::sin(n[0] * kDegree);
  const SvgMatrix turn = {c, s, -s, c, 0, 0};
  if (n.size() == 1) return turn;
  return product(product({1, 0, 0, 1, n[1], n[2]}, turn), {1, 0, 0, 1, -n[1], -n[2]});
}

}  // namespace

SvgMatrix product(const SvgMatrix& outer, const SvgMatrix& inner) {
  const auto& [a, b, c, d, e, f] = outer;
  return {a * inner[0] + c * inner[1], b * inner[0] + d * inner[1],     a * inner[2] + c * inner[3],
          b * inner[2] + d * inner[3], a * inner[4] + c * inner[5] + e, b * inner[4] + d * inner[5] + f};
}

bool has_inverse(const SvgMatrix& m) {
  // kLeastSize: least squared scale; its square and its inverse still fit into a double. kLeastShare: least
  // determinant, as a share of that scale; below, undoing the transform leaves fewer than four right digits. Not
  // measured.
  constexpr double kLeastSize = 1e-100, kLeastShare = 1e-12;
  const double size = m[0] * m[0] + m[1] * m[1] + m[2] * m[2] + m[3] * m[3];
  return size > kLeastSize && size < 1 / kLeastSize && std::abs(determinant(m)) > kLeastShare * size &&
         std::isfinite(m[4]) && std::isfinite(m[5]);
}

Vec3d transformed(const SvgMatrix& m, const Vec2d& p) {
  return {m[0] * p[0] + m[2] * p[1] + m[4], m[1] * p[0] + m[3] * p[1] + m[5], 0};
}

Vec2d transformed_back(const SvgMatrix& m, const Vec3d& p) {
  const double x = p[0] - m[4], y = p[1] - m[5], det = determinant(m);
  return {(m[3] * x - m[2] * y) / det, (m[0] * y - m[1] * x) / det};
}

bool holds_name(std::string_view names, std::string_view name) {
  while (!names.empty()) {
    const std::string_view first = names.substr(0, names.find(' '));
    if (first == name) return true;
    names.remove_prefix(std::min(first.size() + 1, names.size()));
  }
  return false;
}

std::optional<SvgDeclaration> declared_in(std::string_view style, std::string_view names) {
  const auto trimmed = [](std::string_view text) {
    while (!text.empty() && is_svg_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_svg_space(text.back())) text.remove_suffix(1);
    return text;
  };
  std::optional<SvgDeclaration> last;
  while (!style.empty()) {
    const std::string_view declaration = style.substr(0, style.find(';'));
    style.remove_prefix(std::min(declaration.size() + 1, style.size()));
    const std::size_t colon = std::min(declaration.find(':'), declaration.size());
    const std::string_view name = trimmed(declaration.substr(0, colon));
    if (name.empty() || !holds_name(names, name)) continue;
    last = {name, trimmed(declaration.substr(std::min(colon + 1, declaration.size())))};
  }
  return last;
}

SvgMatrix parse_transform(SvgValueScanner value) {
  SvgMatrix all = kSvgIdentity;
  while (!value.at_end()) {
    const std::string_view name = value.function_name();
    all = product(all, parse_function(value, name));
  }
  return all;
}

}  // namespace vdb_offset::io
