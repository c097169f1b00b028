// SPDX-License-Identifier: Apache-2.0
// Prints what an offset is to the last bit, and uses in its own code what the library's headers bring along: with other
// flags that has other machine code here, which must not take the place of the library's.
#include <vdb_offset/curve_offset.h>
#include <vdb_offset/iso_surface.h>
#include <vdb_offset/offset.h>
#include <vdb_offset/shapes.h>
#include <vdb_offset/shell.h>

#include <bit>
#include <cstdint>
#include <cstdio>

using vdb_offset::Vec3d;

// Called by address, these are compiled here as functions of their own.
volatile bool always = true;
using Product = double (Vec3d::*)(const Vec3d&) const;

static double use_of_headers() {
  const Product dot = &Vec3d::dot;
  Vec3d a(0.1, 0.2, 0.3), b(0.7, 0.8, 0.9);
  double sum = always ? (a.*dot)(b) : 0;
  for (int i = 0; i < 1000; ++i) {
    b = a.cross(b) * 0.3 + a;
    double length;
    b = b.unit(1e-9, length);
    sum += b.dot(a) / (1 + a.length());
  }
  return sum;
}

static void print(const char* what, const std::vector<Vec3d>& positions) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const Vec3d& p : positions)
    for (int k = 0; k < 3; ++k) hash = (hash ^ std::bit_cast<std::uint64_t>(p[k])) * 1099511628211u;
  std::printf("%s %016llx\n", what, static_cast<unsigned long long>(hash));
}

int main() {
  if (use_of_headers() == 12345) return 1;
  vdb_offset::Polygons ball = vdb_offset::shapes::bumpy_sphere(1, 0.2, 3, 7, 4);
  for (const double distance : {0.05, -0.2}) {
    const auto result = vdb_offset::offset(ball.view(), {.distance = distance});
    print("offset", result.positions);
    print("achieved", {Vec3d(result.statistics.faces.mean, result.statistics.limit.thickness_lost, 0)});
  }
  print("iso", vdb_offset::make_iso_surface(ball.view(), {.distance = 0.1}).polygons.positions);
  // Products of such lengths are small; a program that flushes what is tiny to zero must not have the library do so.
  for (Vec3d& p : ball.positions) p = Vec3d(p[0] * 0x1p-90, p[1] * 0x1p-90, p[2] * 0x1p-90);
  print("small", vdb_offset::offset(ball.view(), {.distance = -0x1p-92}).positions);
}
