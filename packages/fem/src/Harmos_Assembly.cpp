// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Assembly.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace Harmos::fem {
namespace {

using Vec2 = std::array<double, 2>;
constexpr int cellNodes = Mesh::nodesPerCell;
using CellCoordinates = std::array<Vec2, cellNodes>;

CellCoordinates cellCoordinates(const Mesh& mesh, int cell) {
  CellCoordinates result;
  for (std::size_t i = 0; i < cellNodes; ++i) {
    const auto node = static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(cell) * cellNodes + i]);
    result[i] = {mesh.coordinates[2 * node], mesh.coordinates[2 * node + 1]};
  }
  return result;
}

struct Jacobian {
  double xr = 0, xs = 0, yr = 0, ys = 0; // ∂x/∂r, ∂x/∂s, ∂y/∂r, ∂y/∂s
  double determinant() const { return xr * ys - xs * yr; }
};

// The coordinates relative to the first corner keep the cell's place out of the rounding errors.
Jacobian jacobian(const CellCoordinates& x, const ReferenceElement& element, int q) {
  Jacobian j;
  for (int i = 1; i < cellNodes; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double dx = x[k][0] - x[0][0], dy = x[k][1] - x[0][1];
    const Vec2& gradient = element.gradient(i, q);
    j.xr += dx * gradient[0];
    j.xs += dx * gradient[1];
    j.yr += dy * gradient[0];
    j.ys += dy * gradient[1];
  }
  return j;
}

using CellMatrix = std::array<std::array<double, cellNodes>, cellNodes>;

CellMatrix laplaceMatrix(const CellCoordinates& x, const ReferenceElement& element, int cell) {
  CellMatrix k{};
  for (int q = 0; q < element.points(); ++q) {
    const Jacobian j = jacobian(x, element, q);
    const double det = j.determinant();
    if (!(det > 0.0))
      throw NumericalError("cell " + std::to_string(cell) + " is inverted or has no area: its Jacobian is " +
                               std::to_string(det) +
                               "; number its corners counter-clockwise and check their coordinates",
                           {{"cell", std::to_string(cell)}, {"jacobian", std::to_string(det)}});
    const double weight = element.quadrature().weights[static_cast<std::size_t>(q)];
    std::array<Vec2, cellNodes> gradient;
    for (int i = 0; i < cellNodes; ++i) {
      const Vec2& g = element.gradient(i, q);
      gradient[static_cast<std::size_t>(i)] = {(j.ys * g[0] - j.yr * g[1]) / det,
                                               (j.xr * g[1] - j.xs * g[0]) / det};
    }
    for (std::size_t a = 0; a < cellNodes; ++a)
      for (std::size_t b = 0; b < cellNodes; ++b)
        k[a][b] += weight * det * (gradient[a][0] * gradient[b][0] + gradient[a][1] * gradient[b][1]);
  }
  return k;
}

// Columns of each row from the cells around each node.
LocalMatrix emptyMatrix(const Mesh& mesh) {
  const auto n = static_cast<std::size_t>(mesh.numberOfNodes());
  std::vector<std::vector<int>> neighbours(n);
  for (std::size_t c = 0; c < mesh.cells.size(); c += cellNodes)
    for (std::size_t a = 0; a < cellNodes; ++a) {
      std::vector<int>& row = neighbours[static_cast<std::size_t>(mesh.cells[c + a])];
      row.insert(row.end(), mesh.cells.begin() + static_cast<std::ptrdiff_t>(c),
                 mesh.cells.begin() + static_cast<std::ptrdiff_t>(c + cellNodes));
    }
  LocalMatrix matrix;
  matrix.offsets.reserve(n + 1);
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    matrix.columns.insert(matrix.columns.end(), row.begin(), row.end());
    matrix.offsets.push_back(matrix.columns.size());
  }
  matrix.values.assign(matrix.columns.size(), 0.0);
  return matrix;
}

void addTo(LocalMatrix& matrix, int row, int column, double value) {
  const auto begin =
      matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[static_cast<std::size_t>(row)]);
  const auto end =
      matrix.columns.begin() + static_cast<std::ptrdiff_t>(matrix.offsets[static_cast<std::size_t>(row) + 1]);
  const auto place = std::lower_bound(begin, end, column);
  matrix.values[static_cast<std::size_t>(place - matrix.columns.begin())] += value;
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
                                            const ReferenceElement& element, const Quadrature& triangle) {
  std::array<double, cellNodes> result{};
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Vec2 &a = polygon[0], &b = polygon[k], &c = polygon[k + 1];
    const double det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    std::vector<Vec2> points;
    for (const Vec2& q : triangle.points)
      points.push_back(toReference(x, {a[0] + q[0] * (b[0] - a[0]) + q[1] * (c[0] - a[0]),
                                       a[1] + q[0] * (b[1] - a[1]) + q[1] * (c[1] - a[1])}));
    const std::vector<std::vector<double>> values = element.valuesAt(points);
    for (std::size_t q = 0; q < points.size(); ++q)
      for (std::size_t i = 0; i < cellNodes; ++i)
        result[i] += triangle.weights[q] * det * values[q][i];
  }
  return result;
}

} // namespace

LocalMatrix assembleLaplace(const Mesh& mesh) {
  const ReferenceElement element(mesh.cellType, 2);
  LocalMatrix matrix = emptyMatrix(mesh);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    const CellMatrix k = laplaceMatrix(cellCoordinates(mesh, c), element, c);
    const int* nodes = &mesh.cells[static_cast<std::size_t>(c) * cellNodes];
    for (std::size_t a = 0; a < cellNodes; ++a)
      for (std::size_t b = 0; b < cellNodes; ++b)
        addTo(matrix, nodes[a], nodes[b], k[a][b]);
  }
  return matrix;
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
  const ReferenceElement element(mesh.cellType, 2);
  const Quadrature triangle = triangleQuadrature(4);
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()), 0.0);
  for (const BoxLoad& load : loads) {
    const Vec2 &least = load.least, &most = load.most;
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      const CellCoordinates x = cellCoordinates(mesh, c);
      bool disjoint = false, within = true;
      for (std::size_t d = 0; d < 2; ++d) {
        const auto [lo, hi] = std::minmax({x[0][d], x[1][d], x[2][d], x[3][d]});
        disjoint = disjoint || hi <= least[d] || lo >= most[d];
        within = within && lo >= least[d] && hi <= most[d];
      }
      if (disjoint)
        continue;
      std::array<double, cellNodes> integrals{};
      if (within) {
        for (int q = 0; q < element.points(); ++q) {
          const double measure = element.quadrature().weights[static_cast<std::size_t>(q)] *
                                 jacobian(x, element, q).determinant();
          for (int i = 0; i < cellNodes; ++i)
            integrals[static_cast<std::size_t>(i)] += measure * element.value(i, q);
        }
      } else {
        std::vector<Vec2> polygon(x.begin(), x.end());
        for (std::size_t d = 0; d < 2 && !polygon.empty(); ++d) {
          polygon = clip(polygon, d, least[d], true);
          polygon = clip(polygon, d, most[d], false);
        }
        integrals = integrateOver(polygon, x, element, triangle);
      }
      for (std::size_t i = 0; i < cellNodes; ++i)
        f[static_cast<std::size_t>(mesh.cells[static_cast<std::size_t>(c) * cellNodes + i])] +=
            load.value * integrals[i];
    }
  }
  return f;
}

} // namespace Harmos::fem
