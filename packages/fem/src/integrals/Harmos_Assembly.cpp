// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Assembly.hpp"

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::fem {
namespace {

using Vec2 = std::array<double, 2>;
constexpr int cellNodes = 4; // box loads are for quadrilaterals of four nodes
using CellCoordinates = std::array<Vec2, cellNodes>;

CellCoordinates cellCoordinates(const Mesh& mesh, int cell) {
  CellCoordinates result;
  for (std::size_t i = 0; i < cellNodes; ++i) {
    const Point x = mesh.local(mesh.cell(cell)[i]);
    result[i] = {x[0], x[1]};
  }
  return result;
}

// The part of a convex polygon on one side of an axis-parallel line: Sutherland–Hodgman.
std::vector<Vec2> clip(const std::vector<Vec2>& polygon, std::size_t axis, double bound, bool keepGreater) {
  std::vector<Vec2> result;
  const auto inside = [&](const Vec2& p) { return keepGreater ? p[axis] >= bound : p[axis] <= bound; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    if (inside(a))
      result.push_back(a);
    if (inside(a) != inside(b)) {
      const double t = (bound - a[axis]) / (b[axis] - a[axis]);
      Vec2 cut = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
      cut[axis] = bound;
      result.push_back(cut);
    }
  }
  return result;
}

// Reference coordinates of a point of a bilinear quadrilateral by Newton's method; one step for a
// parallelogram.
Vec2 toReference(const CellCoordinates& x, const Vec2& point) {
  Vec2 r = {0.0, 0.0};
  const double size = std::abs(x[2][0] - x[0][0]) + std::abs(x[2][1] - x[0][1]);
  for (int iteration = 0; iteration < 30; ++iteration) {
    const std::array<double, 4> n = {0.25 * (1 - r[0]) * (1 - r[1]), 0.25 * (1 + r[0]) * (1 - r[1]),
                                     0.25 * (1 + r[0]) * (1 + r[1]), 0.25 * (1 - r[0]) * (1 + r[1])};
    const std::array<Vec2, 4> d = {{{-0.25 * (1 - r[1]), -0.25 * (1 - r[0])},
                                    {0.25 * (1 - r[1]), -0.25 * (1 + r[0])},
                                    {0.25 * (1 + r[1]), 0.25 * (1 + r[0])},
                                    {-0.25 * (1 + r[1]), 0.25 * (1 - r[0])}}};
    double ex = -point[0], ey = -point[1], a = 0, b = 0, c = 0, e = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      ex += n[i] * x[i][0];
      ey += n[i] * x[i][1];
      a += d[i][0] * x[i][0];
      b += d[i][1] * x[i][0];
      c += d[i][0] * x[i][1];
      e += d[i][1] * x[i][1];
    }
    const double det = a * e - b * c;
    r[0] -= (e * ex - b * ey) / det;
    r[1] -= (a * ey - c * ex) / det;
    if (std::abs(ex) + std::abs(ey) <= 1e-15 * size)
      break;
  }
  return r;
}

// ∫ φ_i over a convex polygon inside a cell.
std::array<double, cellNodes> integrateOver(const std::vector<Vec2>& polygon, const CellCoordinates& x,
                                            const Quadrature& triangle) {
  std::array<double, cellNodes> result{};
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Vec2 &a = polygon[0], &b = polygon[k], &c = polygon[k + 1];
    const double det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    std::vector<Point> points;
    for (const Point& q : triangle.points) {
      const Vec2 r = toReference(x, {a[0] + q[0] * (b[0] - a[0]) + q[1] * (c[0] - a[0]),
                                     a[1] + q[0] * (b[1] - a[1]) + q[1] * (c[1] - a[1])});
      points.push_back({r[0], r[1], 0.0});
    }
    const std::vector<std::vector<double>> values = basisValues(CellType::Quadrilateral4, points);
    for (std::size_t q = 0; q < points.size(); ++q)
      for (std::size_t i = 0; i < cellNodes; ++i)
        result[i] += triangle.weights[q] * det * values[q][i];
  }
  return result;
}

} // namespace

LocalMatrix assembleLaplace(const Mesh& mesh) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const ReferenceElement element(mesh.cellType, shape.isSimplex ? 2 * (shape.order - 1) : 2 * shape.order);
  CellIntegrator cell(mesh, element);
  BlockAssembler assembler(mesh, 1);
  const auto n = static_cast<std::size_t>(cell.basisSize());
  std::vector<double> k(n * n);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    std::fill(k.begin(), k.end(), 0.0);
    for (int q = 0; q < cell.points(); ++q)
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b) {
          const Point &ga = cell.gradient(static_cast<int>(a), q),
                      &gb = cell.gradient(static_cast<int>(b), q);
          k[a * n + b] += cell.measure(q) * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
        }
    assembler.add(c, k);
  }
  return assembler.take();
}

std::vector<BoxLoad> localLoads(const PlacedMesh& placed, const std::vector<BoxLoad>& loads) {
  const std::vector<double>& x = placed.mesh->coordinates;
  Vec2 least = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2 most = {-least[0], -least[1]};
  for (std::size_t k = 0; k < x.size(); ++k) {
    least[k % 2] = std::min(least[k % 2], x[k]);
    most[k % 2] = std::max(most[k % 2], x[k]);
  }
  std::vector<BoxLoad> result;
  for (const BoxLoad& load : loads) {
    BoxLoad local = load;
    bool meets = true;
    for (std::size_t d = 0; d < 2; ++d) {
      local.least[d] = std::max(least[d], load.least[d] - placed.anchor[d]);
      local.most[d] = std::min(most[d], load.most[d] - placed.anchor[d]);
      meets = meets && local.least[d] < local.most[d];
    }
    if (meets)
      result.push_back(local);
  }
  return result;
}

std::vector<double> assembleLoad(const Mesh& mesh, const std::vector<BoxLoad>& loads) {
  if (loads.empty())
    return std::vector<double>(static_cast<std::size_t>(mesh.numberOfNodes()), 0.0);
  const CellShape& shape = shapeOf(mesh.cellType);
  const ReferenceElement element(mesh.cellType, 2 * shape.order);
  CellIntegrator cell(mesh, element);
  const Quadrature triangle = quadratureOn(CellType::Triangle3, 4);
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()), 0.0);
  for (const BoxLoad& load : loads) {
    const Vec2 &least = load.least, &most = load.most;
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      bool disjoint = false, within = true;
      for (std::size_t d = 0; d < 2; ++d) {
        double lo = std::numeric_limits<double>::infinity(), hi = -lo;
        for (int i = 0; i < shape.nodes; ++i) {
          const double x = mesh.local(mesh.cell(c)[i])[d];
          lo = std::min(lo, x);
          hi = std::max(hi, x);
        }
        disjoint = disjoint || hi <= least[d] || lo >= most[d];
        within = within && lo >= least[d] && hi <= most[d];
      }
      if (disjoint)
        continue;
      if (within) {
        cell.turnTo(c);
        for (int q = 0; q < cell.points(); ++q)
          for (int i = 0; i < cell.basisSize(); ++i)
            f[static_cast<std::size_t>(mesh.cell(c)[i])] += load.value * cell.measure(q) * cell.value(i, q);
        continue;
      }
      HARMOS_REQUIRE(mesh.cellType == CellType::Quadrilateral4,
                     "loads whose edges cut cells are for quadrilaterals of four nodes");
      const CellCoordinates x = cellCoordinates(mesh, c);
      std::vector<Vec2> polygon(x.begin(), x.end());
      for (std::size_t d = 0; d < 2 && !polygon.empty(); ++d) {
        polygon = clip(polygon, d, least[d], true);
        polygon = clip(polygon, d, most[d], false);
      }
      const std::array<double, cellNodes> integrals = integrateOver(polygon, x, triangle);
      for (std::size_t i = 0; i < cellNodes; ++i)
        f[static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(c) * cellNodes + i])] +=
            load.value * integrals[i];
    }
  }
  return f;
}

} // namespace Harmos::fem
