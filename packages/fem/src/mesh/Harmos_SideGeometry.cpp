// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SideGeometry.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <iomanip>
#include <sstream>

namespace Harmos::fem {

SideGeometry geometryOf(const Mesh& mesh, const Point& anchor, const Side& side) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const std::vector<int>& nodes = shape.sides[static_cast<std::size_t>(side.side)];
  const auto corners = static_cast<std::size_t>(shapeOf(mesh.typeOf(side)).corners);
  SideGeometry result;
  for (std::size_t k = 0; k < corners; ++k) {
    result.corners.push_back(sum(anchor, mesh.local(mesh.cell(side.cell)[nodes[k]])));
    result.middle = sum(result.middle, scaled(1.0 / static_cast<double>(corners), result.corners.back()));
  }
  const std::vector<Point>& x = result.corners;
  Point normal{};
  if (corners == 2) // turned clockwise: the cell lies to the left of its sides
    normal = {x[1][1] - x[0][1], x[0][0] - x[1][0], 0.0};
  else if (corners == 3)
    normal = scaled(0.5, cross(difference(x[1], x[0]), difference(x[2], x[0])));
  else
    normal = scaled(0.5, cross(difference(x[2], x[0]), difference(x[3], x[1])));
  result.area = norm(normal);
  if (result.area > 0.0)
    result.normal = scaled(1.0 / result.area, normal);
  return result;
}

SideGeometry geometryOf(const PlacedMesh& placed, const Side& side) {
  return geometryOf(*placed.mesh, placed.anchor, side);
}

void SidesGeometry::add(const SideGeometry& side) {
  ++sides;
  area += side.area;
  normals = sum(normals, scaled(side.area, side.normal));
  std::vector<Point> points = side.corners;
  if (box) {
    points.push_back(box->low);
    points.push_back(box->high);
  }
  box = boxAround(points);
}

std::optional<Point> SidesGeometry::commonNormal() const {
  // 1 − cos of 0.03 degrees is 1.4e-7, a mean over the sides.
  constexpr double flat = 1e-7;
  const double length = norm(normals);
  if (area <= 0.0 || length < (1.0 - flat) * area)
    return std::nullopt;
  return scaled(1.0 / length, normals);
}

SidesGeometry overAll(const Teuchos::Comm<int>& comm, const SidesGeometry& mine) {
  struct Share {
    long long sides;
    double area;
    Point normals;
    Box box;
  };
  SidesGeometry all;
  std::vector<Share> shares;
  if (mine.sides > 0)
    shares.push_back({mine.sides, mine.area, mine.normals, *mine.box});
  for (const Share& share : gatherAll(comm, shares)) {
    all.sides += share.sides;
    all.area += share.area;
    all.normals = sum(all.normals, share.normals);
    all.box = all.box ? boxAround({all.box->low, all.box->high, share.box.low, share.box.high}) : share.box;
  }
  return all;
}

std::string textOf(const SidesGeometry& sides) {
  std::ostringstream text;
  text << std::setprecision(4);
  const auto put = [&](const Point& x) {
    text << '(';
    for (std::size_t d = 0; d < 3; ++d)
      text << (d > 0 ? ", " : "") << (std::abs(x[d]) < 1e-12 ? 0.0 : x[d]);
    text << ')';
  };
  text << sides.area;
  if (const std::optional<Point> normal = sides.commonNormal()) {
    text << ", flat with normal ";
    put(*normal);
  } else {
    text << ", not flat";
  }
  if (sides.box) {
    text << ", from ";
    put(sides.box->low);
    text << " to ";
    put(sides.box->high);
  }
  return text.str();
}

} // namespace Harmos::fem
