// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PointLocator.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::fem {
namespace {

// In coordinates of the reference cell, whose size is one or two: rounding errors of the Newton steps are
// eps times the aspect ratio of a cell, which this leaves room for.
constexpr double insideTolerance = 1e-9;

double norm(const Point& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

Point difference(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Reference coordinates that are those of a simplex, the first ones.
std::size_t barycentricOf(const CellShape& shape) {
  return shape.isSimplex ? static_cast<std::size_t>(shape.dimension) : shape.isWedge ? 2 : 0;
}

bool isInside(const CellShape& shape, const Point& x) {
  const auto dimension = static_cast<std::size_t>(shape.dimension), barycentric = barycentricOf(shape);
  double rest = 1.0;
  for (std::size_t d = 0; d < dimension; ++d) {
    if (x[d] < (d < barycentric ? 0.0 : -1.0) - insideTolerance || x[d] > 1.0 + insideTolerance)
      return false;
    rest -= d < barycentric ? x[d] : 0.0;
  }
  return rest >= -insideTolerance;
}

Point centreOf(const CellShape& shape) {
  Point x{};
  const std::size_t barycentric = barycentricOf(shape);
  for (std::size_t d = 0; d < barycentric; ++d)
    x[d] = 1.0 / static_cast<double>(barycentric + 1);
  return x;
}

// Solves the symmetric positive definite system of order d in place; false if it is singular.
bool solveSmall(std::array<Point, 3>& a, Point& b, std::size_t d) {
  for (std::size_t k = 0; k < d; ++k) {
    if (!(a[k][k] > 0.0))
      return false;
    for (std::size_t i = k + 1; i < d; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < d; ++j)
        a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = d; k-- > 0;) {
    for (std::size_t j = k + 1; j < d; ++j)
      b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return true;
}

// A second-order cell bulges beyond the box of its nodes, by at most a quarter of its size.
Box boxOf(const CellShape& shape, const std::vector<Point>& points) {
  const Box box = boxAround(points);
  return widened(box, (shape.order == 2 ? 0.25 : 1e-9) * norm(difference(box.high, box.low)));
}

} // namespace

PointLocator::PointLocator(CellType type, std::vector<Point> nodes, std::vector<int> cells)
    : type_(type), shape_(shapeOf(type)), nodes_(std::move(nodes)), cells_(std::move(cells)), tree_(boxes()) {
  HARMOS_REQUIRE(!cells_.empty(), "a locator has no cells");
  const Box all = boxAround(nodes_);
  extent_ = norm(difference(all.high, all.low));
  double sizes = 0.0;
  for (const Box& box : boxes())
    sizes += norm(difference(box.high, box.low));
  cellSize_ = sizes / numberOfCells();
}

std::vector<Box> PointLocator::boxes() const {
  std::vector<Box> result;
  for (int c = 0; c < numberOfCells(); ++c) {
    const Piece here = piece(c);
    std::vector<Point> points;
    for (std::size_t i = 0; i < static_cast<std::size_t>(shape_.nodes); ++i)
      points.push_back(nodes_[static_cast<std::size_t>(here.nodes[i])]);
    result.push_back(boxOf(shape_, points));
  }
  return result;
}

PointLocator::Piece PointLocator::piece(int cell) const {
  Piece result{type_, {}};
  std::copy_n(cells_.begin() + static_cast<std::ptrdiff_t>(cell) * shape_.nodes, shape_.nodes,
              result.nodes.begin());
  return result;
}

// Gauss-Newton from the middle; whether it ended within the cell.
bool PointLocator::solve(const Piece& piece, const Point& x, Point& reference, double& distance) const {
  const CellShape& shape = shapeOf(piece.type);
  const auto dimension = static_cast<std::size_t>(shape.dimension);
  const auto count = static_cast<std::size_t>(shape.nodes);
  CellBasis basis;
  reference = centreOf(shape);
  constexpr int mostSteps = 30;
  for (int step = 0; step < mostSteps; ++step) {
    cellBasis(shape, reference, basis);
    Point residual = x;
    std::array<Point, 3> jacobian{}; // jacobian[b] = ∂X/∂ξ_b
    for (std::size_t i = 0; i < count; ++i) {
      const Point& node = nodes_[static_cast<std::size_t>(piece.nodes[i])];
      for (std::size_t a = 0; a < 3; ++a) {
        residual[a] -= basis.values[i] * node[a];
        for (std::size_t b = 0; b < dimension; ++b)
          jacobian[b][a] += basis.gradients[i][b] * node[a];
      }
    }
    distance = norm(residual);
    std::array<Point, 3> normal{};
    Point change{};
    for (std::size_t b = 0; b < dimension; ++b)
      for (std::size_t a = 0; a < 3; ++a) {
        change[b] += jacobian[b][a] * residual[a];
        for (std::size_t c = 0; c < dimension; ++c)
          normal[b][c] += jacobian[b][a] * jacobian[c][a];
      }
    if (!solveSmall(normal, change, dimension))
      return false;
    for (std::size_t b = 0; b < dimension; ++b)
      reference[b] += change[b];
    // Far outside there is nothing to be found, and the map may fold.
    constexpr double far = 20.0;
    if (!(norm(reference) < far))
      return false;
    if (norm(change) <= 1e-13)
      return isInside(shape, reference);
  }
  return norm(reference) < 2.0 && isInside(shape, reference);
}

bool PointLocator::contains(int cell, const Point& x, Place& place) const {
  place.cell = cell;
  // The distance is that before the last step: rounding where that step was.
  return solve(piece(cell), x, place.reference, place.distance) &&
         place.distance <= insideTolerance * (extent_ + cellSize_);
}

double PointLocator::nearestOn(const Piece& piece, const Point& x, Point& reference) const {
  const CellShape& shape = shapeOf(piece.type);
  double distance = 0.0;
  if (solve(piece, x, reference, distance))
    return distance;
  double least = std::numeric_limits<double>::infinity();
  if (shape.dimension == 1) {
    for (std::size_t end = 0; end < 2; ++end) {
      distance = norm(difference(x, nodes_[static_cast<std::size_t>(piece.nodes[end])]));
      if (distance < least) {
        least = distance;
        reference = shape.nodeCoordinates[end];
      }
    }
    return least;
  }
  for (std::size_t s = 0; s < shape.sides.size(); ++s) {
    const std::vector<int>& side = shape.sides[s];
    Piece part{shape.sideTypes[s], {}};
    for (std::size_t k = 0; k < side.size(); ++k)
      part.nodes[k] = piece.nodes[static_cast<std::size_t>(side[k])];
    Point onSide{};
    distance = nearestOn(part, x, onSide);
    if (distance < least) {
      least = distance;
      CellBasis basis;
      cellBasis(shapeOf(part.type), onSide, basis);
      reference = {};
      for (std::size_t k = 0; k < side.size(); ++k)
        for (std::size_t d = 0; d < 3; ++d)
          reference[d] += basis.values[k] * shape.nodeCoordinates[static_cast<std::size_t>(side[k])][d];
    }
  }
  return least;
}

PointLocator::Place PointLocator::nearest(const Point& x, int hint) const {
  Place place;
  if (hint >= 0 && contains(hint, x, place))
    return place;
  const double tolerance = insideTolerance * (extent_ + cellSize_);
  for (int cell : tree_.touching(widened({x, x}, tolerance)))
    if (contains(cell, x, place))
      return place;
  Place best;
  best.distance = std::numeric_limits<double>::infinity();
  // What is nearer than the radius has a box within it.
  for (double radius = 0.1 * cellSize_; best.distance > radius; radius *= 3.0)
    for (int cell : tree_.touching(widened({x, x}, radius))) {
      const double distance = nearestOn(piece(cell), x, place.reference);
      if (distance < best.distance) {
        best = place;
        best.cell = cell;
        best.distance = distance;
      }
    }
  return best;
}

Point PointLocator::position(const Place& place) const {
  CellBasis basis;
  cellBasis(shape_, place.reference, basis);
  const Piece here = piece(place.cell);
  Point x{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(shape_.nodes); ++i)
    for (std::size_t d = 0; d < 3; ++d)
      x[d] += basis.values[i] * nodes_[static_cast<std::size_t>(here.nodes[i])][d];
  return x;
}

Point PointLocator::value(const Place& place, const std::vector<double>& values, int components) const {
  CellBasis basis;
  cellBasis(shape_, place.reference, basis);
  const Piece here = piece(place.cell);
  const auto m = static_cast<std::size_t>(components);
  Point result{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(shape_.nodes); ++i)
    for (std::size_t a = 0; a < m; ++a)
      result[a] += basis.values[i] * values[static_cast<std::size_t>(here.nodes[i]) * m + a];
  return result;
}

FieldValue PointLocator::valueAndGradient(const Place& place, const std::vector<double>& values,
                                          int components) const {
  CellBasis basis;
  cellBasis(shape_, place.reference, basis);
  const int* here = cells_.data() + static_cast<std::ptrdiff_t>(place.cell) * shape_.nodes;
  const auto m = static_cast<std::size_t>(components);
  const auto dimension = static_cast<std::size_t>(shape_.dimension);
  FieldValue result;
  // ∂u_a/∂ξ_b and Jᵀ with Jᵀ[b][c] = ∂X_c/∂ξ_b; then Jᵀ ∇u = ∂u/∂ξ.
  std::array<Point, 3> slope{}, jacobian{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(shape_.nodes); ++i) {
    const auto node = static_cast<std::size_t>(here[i]);
    for (std::size_t a = 0; a < m; ++a) {
      const double u = values[node * m + a];
      result.value[a] += basis.values[i] * u;
      for (std::size_t b = 0; b < dimension; ++b)
        slope[a][b] += basis.gradients[i][b] * u;
    }
    for (std::size_t b = 0; b < dimension; ++b)
      for (std::size_t c = 0; c < dimension; ++c)
        jacobian[b][c] += basis.gradients[i][b] * nodes_[node][c];
  }
  // J Jᵀ ∇u = J ∂u/∂ξ keeps the matrix symmetric positive definite.
  std::array<Point, 3> matrix{};
  for (std::size_t b = 0; b < dimension; ++b)
    for (std::size_t c = 0; c < dimension; ++c)
      for (std::size_t e = 0; e < dimension; ++e)
        matrix[c][e] += jacobian[b][c] * jacobian[b][e];
  for (std::size_t a = 0; a < m; ++a) {
    Point& g = result.gradient[a];
    for (std::size_t b = 0; b < dimension; ++b)
      for (std::size_t c = 0; c < dimension; ++c)
        g[c] += jacobian[b][c] * slope[a][b];
    std::array<Point, 3> copy = matrix;
    HARMOS_REQUIRE(solveSmall(copy, g, dimension), "a cell has no volume");
  }
  return result;
}

} // namespace Harmos::fem
