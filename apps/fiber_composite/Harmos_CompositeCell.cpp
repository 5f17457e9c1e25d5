// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CompositeCell.hpp"

#include <cmath>

namespace Harmos::composite {
namespace {

using fem::Point;

const double pi = std::acos(-1.0);

Point onCircle(const Cell& cell, double turn) {
  const double angle = 2.0 * pi * turn - 0.75 * pi;
  return {cell.centre[0] + cell.radius * std::cos(angle), cell.centre[1] + cell.radius * std::sin(angle),
          0.0};
}

// A square about a centre, counter-clockwise from its lower left corner.
Point onSquare(const Point& centre, double half, int place, int perSide) {
  const int side = place / perSide % 4;
  const double t = -1.0 + 2.0 * (place % perSide) / perSide;
  const std::array<Point, 4> points = {{{t, -1, 0}, {1, t, 0}, {-t, 1, 0}, {-1, -t, 0}}};
  const Point& x = points[static_cast<std::size_t>(side)];
  return {centre[0] + half * x[0], centre[1] + half * x[1], 0.0};
}

Point between(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), 0.0};
}

// The core of the fibre reaches this far to its corners, in radii; a compromise between thin elements at the
// corners and blunt ones in the middle of the sides.
constexpr double core = 0.55;

class Builder {
 public:
  explicit Builder(const Cell& cell) : shape_(fem::shapeOf(cell.cellType)) { mesh_.cellType = cell.cellType; }

  int add(const Point& x) {
    mesh_.coordinates.push_back(x[0]);
    mesh_.coordinates.push_back(x[1]);
    return mesh_.numberOfNodes() - 1;
  }

  // A cell from the node at each place (i, j) of its lattice of (order + 1)².
  template<class At>
  void addCell(At&& at) {
    for (const Point& r : shape_.nodeCoordinates)
      mesh_.cells.push_back(at(static_cast<int>(std::lround(0.5 * (1.0 + r[0]) * shape_.order)),
                               static_cast<int>(std::lround(0.5 * (1.0 + r[1]) * shape_.order))));
  }

  fem::BodyMesh finish(const std::string& name) {
    fem::BodyMesh body;
    body.name = name;
    mesh_.boundary = fem::nodesOf(mesh_, fem::boundarySides(mesh_));
    body.mesh = std::move(mesh_);
    body.regions = {name};
    return body;
  }

 private:
  const fem::CellShape& shape_;
  fem::Mesh mesh_;
};

} // namespace

fem::BodyMesh fibreMesh(const Cell& cell) {
  const int p = fem::shapeOf(cell.cellType).order, n = cell.elementsPerSide * p, around = 4 * n;
  Builder builder(cell);
  const double half = core * cell.radius / std::sqrt(2.0);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      builder.add(
          {cell.centre[0] + half * (2.0 * i / n - 1.0), cell.centre[1] + half * (2.0 * j / n - 1.0), 0.0});
  // Of the core, its boundary is layer 0.
  const auto coreNode = [n](int place) {
    const int k = place % n;
    switch (place / n % 4) {
    case 0:
      return k;
    case 1:
      return n + k * (n + 1);
    case 2:
      return n * (n + 1) + n - k;
    default:
      return (n - k) * (n + 1);
    }
  };
  const int layers = cell.fibreLayers * p, ring = (n + 1) * (n + 1);
  for (int layer = 1; layer <= layers; ++layer)
    for (int k = 0; k < around; ++k)
      builder.add(between(onSquare(cell.centre, half, k, n), onCircle(cell, static_cast<double>(k) / around),
                          static_cast<double>(layer) / layers));
  const auto ringNode = [&](int layer, int k) {
    return layer == 0 ? coreNode(k % around) : ring + (layer - 1) * around + k % around;
  };
  for (int j = 0; j < n; j += p)
    for (int i = 0; i < n; i += p)
      builder.addCell([&](int a, int b) { return (j + b) * (n + 1) + i + a; });
  // Radially outward, then counter-clockwise.
  for (int layer = 0; layer < layers; layer += p)
    for (int k = 0; k < around; k += p)
      builder.addCell([&](int a, int b) { return ringNode(layer + a, k + b); });
  fem::BodyMesh body = builder.finish("fibre");
  body.sides["surface"] = fem::boundarySides(body.mesh);
  return body;
}

fem::BodyMesh matrixMesh(const Cell& cell) {
  const int p = fem::shapeOf(cell.cellType).order, n = cell.elementsPerSide * p, around = 4 * n;
  const int layers = cell.matrixLayers * p;
  Builder builder(cell);
  for (int layer = 0; layer <= layers; ++layer)
    for (int k = 0; k < around; ++k)
      builder.add(between(onCircle(cell, static_cast<double>(k) / around),
                          onSquare({}, 0.5 * cell.size, k, n), static_cast<double>(layer) / layers));
  for (int layer = 0; layer < layers; layer += p)
    for (int k = 0; k < around; k += p)
      builder.addCell([&](int a, int b) { return (layer + a) * around + (k + b) % around; });
  fem::BodyMesh body = builder.finish("matrix");
  static const std::array<const char*, 4> names = {"bottom", "right", "top", "left"};
  for (const fem::Side& side : fem::boundarySides(body.mesh)) {
    const int first = body.mesh.nodesOf(side)[0], second = body.mesh.nodesOf(side)[1];
    if (std::max(first, second) < around) {
      body.sides["hole"].push_back(side);
    } else {
      // Sides run counter-clockwise around the square: the place of the lower one, but for the last.
      const int a = first % around, b = second % around;
      const int place = std::abs(a - b) == p ? std::min(a, b) : around - p;
      body.sides[names[static_cast<std::size_t>(place / n)]].push_back(side);
    }
  }
  return body;
}

} // namespace Harmos::composite
