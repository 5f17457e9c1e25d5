// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CellBasis.hpp"

#include <cmath>

namespace Harmos::fem {
namespace {

// The Lagrange polynomial of a node at −1, 0 or 1 on the line, and its derivative.
void lineBasis(double node, int order, double x, double& value, double& derivative) {
  if (order == 1) {
    value = 0.5 * (1.0 + node * x);
    derivative = 0.5 * node;
  } else if (node == 0.0) {
    value = 1.0 - x * x;
    derivative = -2.0 * x;
  } else {
    value = 0.5 * x * (x + node);
    derivative = x + 0.5 * node;
  }
}

void tensorBasis(const CellShape& shape, const Point& x, CellBasis& basis) {
  const auto dimension = static_cast<std::size_t>(shape.dimension);
  // Of nodes at −1, 0 and 1, in each direction.
  std::array<std::array<double, 3>, 3> value, derivative;
  for (std::size_t d = 0; d < 3; ++d) {
    value[d] = {1.0, 1.0, 1.0};
    derivative[d] = {0.0, 0.0, 0.0};
    for (std::size_t k = 0; d < dimension && k < 3; ++k)
      lineBasis(static_cast<double>(k) - 1.0, shape.order, x[d], value[d][k], derivative[d][k]);
  }
  for (std::size_t i = 0; i < shape.nodeCoordinates.size(); ++i) {
    const Point& node = shape.nodeCoordinates[i];
    std::array<std::size_t, 3> at{};
    for (std::size_t d = 0; d < 3; ++d)
      at[d] = node[d] < -0.5 ? 0 : node[d] < 0.5 ? 1 : 2;
    const double a = value[0][at[0]], b = value[1][at[1]], c = value[2][at[2]];
    basis.values[i] = a * b * c;
    basis.gradients[i] = {derivative[0][at[0]] * b * c, a * derivative[1][at[1]] * c,
                          a * b * derivative[2][at[2]]};
  }
}

// Barycentric coordinate k of a point of the simplex, and its constant gradient.
double barycentric(std::size_t k, std::size_t dimension, const Point& x) {
  if (k > 0)
    return x[k - 1];
  double sum = 1.0;
  for (std::size_t d = 0; d < dimension; ++d)
    sum -= x[d];
  return sum;
}
Point barycentricGradient(std::size_t k, std::size_t dimension) {
  Point g{};
  if (k > 0)
    g[k - 1] = 1.0;
  else
    for (std::size_t d = 0; d < dimension; ++d)
      g[d] = -1.0;
  return g;
}

// Corners λ or λ(2λ − 1), middles of edges 4 λ_a λ_b.
void simplexBasis(const CellShape& shape, const Point& x, CellBasis& basis) {
  const auto dimension = static_cast<std::size_t>(shape.dimension);
  for (std::size_t i = 0; i < shape.nodeCoordinates.size(); ++i) {
    std::array<std::size_t, 2> touching{};
    std::size_t count = 0;
    for (std::size_t k = 0; k <= dimension; ++k)
      if (barycentric(k, dimension, shape.nodeCoordinates[i]) > 0.25)
        touching[count++] = k;
    const double a = barycentric(touching[0], dimension, x);
    const Point ga = barycentricGradient(touching[0], dimension);
    if (count == 1) {
      const bool linear = shape.order == 1;
      basis.values[i] = linear ? a : a * (2.0 * a - 1.0);
      for (std::size_t d = 0; d < 3; ++d)
        basis.gradients[i][d] = (linear ? 1.0 : 4.0 * a - 1.0) * ga[d];
    } else {
      const double b = barycentric(touching[1], dimension, x);
      const Point gb = barycentricGradient(touching[1], dimension);
      basis.values[i] = 4.0 * a * b;
      for (std::size_t d = 0; d < 3; ++d)
        basis.gradients[i][d] = 4.0 * (a * gb[d] + b * ga[d]);
    }
  }
}

// A polynomial of the triangle times one of the line. Of 15 nodes, with λ the barycentric coordinate of a
// node and n its place on the axis: on corners ½λ((2λ − 1)(1 + nz) − (1 − z²)), on edges of the triangles
// 2λ_aλ_b(1 + nz), on the others λ(1 − z²) (Bathe: Finite Element Procedures, 1996, 5.3).
void wedgeBasis(const CellShape& shape, const Point& x, CellBasis& basis) {
  static const CellShape &linear = shapeOf(CellType::Triangle3), &quadratic = shapeOf(CellType::Triangle6);
  const CellShape& triangle = shape.order == 1 ? linear : quadratic;
  CellBasis flat, corners;
  simplexBasis(triangle, {x[0], x[1], 0.0}, flat);
  simplexBasis(linear, {x[0], x[1], 0.0}, corners);
  for (std::size_t i = 0; i < shape.nodeCoordinates.size(); ++i) {
    const Point& node = shape.nodeCoordinates[i];
    std::size_t k = 0; // node of the triangle
    while (std::abs(triangle.nodeCoordinates[k][0] - node[0]) +
               std::abs(triangle.nodeCoordinates[k][1] - node[1]) >
           1e-8)
      ++k;
    const bool isLinearAlong = shape.isSerendipity && node[2] != 0.0,
               isLinearAcross = shape.isSerendipity && node[2] == 0.0;
    const CellBasis& across = isLinearAcross ? corners : flat;
    double along = 0.0, slope = 0.0;
    lineBasis(node[2], isLinearAlong ? 1 : shape.order, x[2], along, slope);
    basis.values[i] = across.values[k] * along;
    basis.gradients[i] = {across.gradients[k][0] * along, across.gradients[k][1] * along,
                          across.values[k] * slope};
    if (isLinearAlong && k < 3) { // ½λ(1 − z²) less
      const double bubble = 0.5 * (1.0 - x[2] * x[2]);
      basis.values[i] -= corners.values[k] * bubble;
      for (std::size_t d = 0; d < 2; ++d)
        basis.gradients[i][d] -= corners.gradients[k][d] * bubble;
      basis.gradients[i][2] += corners.values[k] * x[2];
    }
  }
}

// On corners Π ½(1 + n_d x_d) · (Σ n_d x_d − (dimension − 1)), on middles of edges (1 − x_e²) times the
// linear functions of the other directions (Zienkiewicz, Taylor: The Finite Element Method, vol. 1, 2000,
// 8.7 and 8.11).
void serendipityBasis(const CellShape& shape, const Point& x, CellBasis& basis) {
  const auto dimension = static_cast<std::size_t>(shape.dimension);
  for (std::size_t i = 0; i < shape.nodeCoordinates.size(); ++i) {
    const Point& node = shape.nodeCoordinates[i];
    const bool isCorner = i < static_cast<std::size_t>(shape.corners);
    Point factor = {1.0, 1.0, 1.0}, slope{};
    double rest = isCorner ? -(shape.dimension - 1.0) : 1.0;
    for (std::size_t d = 0; d < dimension; ++d) {
      lineBasis(node[d], node[d] == 0.0 ? 2 : 1, x[d], factor[d], slope[d]);
      rest += isCorner ? node[d] * x[d] : 0.0;
    }
    const double product = factor[0] * factor[1] * factor[2];
    basis.values[i] = product * rest;
    for (std::size_t d = 0; d < 3; ++d) {
      const double others = factor[(d + 1) % 3] * factor[(d + 2) % 3];
      basis.gradients[i][d] = slope[d] * others * rest + (isCorner ? product * node[d] : 0.0);
    }
  }
}

} // namespace

void cellBasis(const CellShape& shape, const Point& reference, CellBasis& basis) {
  if (shape.isSimplex)
    simplexBasis(shape, reference, basis);
  else if (shape.isWedge)
    wedgeBasis(shape, reference, basis);
  else if (shape.isSerendipity)
    serendipityBasis(shape, reference, basis);
  else
    tensorBasis(shape, reference, basis);
}

} // namespace Harmos::fem
