// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Facet.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_PointAlgebra.hpp"

namespace Harmos::contact {
namespace {

using fem::CellType;
using fem::Point;

// Lagrange polynomials of the nodes −1, 1, 0, in the order of a line: ends first.
struct Line {
  std::array<double, 3> values{};
  std::array<double, 3> slopes{};
};

Line linear(double x) {
  return {{0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.0}, {-0.5, 0.5, 0.0}};
}

Line quadratic(double x) {
  return {{0.5 * x * (x - 1.0), 0.5 * x * (x + 1.0), 1.0 - x * x}, {x - 0.5, x + 0.5, -2.0 * x}};
}

// Which polynomial of each direction makes a node of the quadrilateral: corners, edges, centre.
constexpr std::array<std::array<std::size_t, 2>, maxFacetNodes> tensor = {
    {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {1, 2}, {2, 1}, {0, 2}, {2, 2}}};

FacetBasis product(const Line& x, const Line& y, std::size_t nodes) {
  FacetBasis basis;
  for (std::size_t k = 0; k < nodes; ++k) {
    const auto [i, j] = tensor[k];
    basis.values[k] = x.values[i] * y.values[j];
    basis.gradients[k] = {x.slopes[i] * y.values[j], x.values[i] * y.slopes[j]};
  }
  return basis;
}

FacetBasis triangle(const FacetPlace& at, bool isQuadratic) {
  const std::array<double, 3> b = {1.0 - at[0] - at[1], at[0], at[1]};
  constexpr std::array<FacetPlace, 3> slopes = {{{-1.0, -1.0}, {1.0, 0.0}, {0.0, 1.0}}};
  FacetBasis basis;
  for (std::size_t k = 0; k < 3; ++k) {
    basis.values[k] = isQuadratic ? b[k] * (2.0 * b[k] - 1.0) : b[k];
    for (std::size_t d = 0; d < 2; ++d)
      basis.gradients[k][d] = isQuadratic ? (4.0 * b[k] - 1.0) * slopes[k][d] : slopes[k][d];
  }
  if (isQuadratic)
    for (std::size_t k = 0; k < 3; ++k) { // in the middle of the edge from corner k to the next
      const std::size_t next = (k + 1) % 3;
      basis.values[3 + k] = 4.0 * b[k] * b[next];
      for (std::size_t d = 0; d < 2; ++d)
        basis.gradients[3 + k][d] = 4.0 * (slopes[k][d] * b[next] + b[k] * slopes[next][d]);
    }
  return basis;
}

FacetBasis line(const Line& x) {
  FacetBasis basis;
  for (std::size_t k = 0; k < 3; ++k) {
    basis.values[k] = x.values[k];
    basis.gradients[k] = {x.slopes[k], 0.0};
  }
  return basis;
}

} // namespace

FacetBasis facetBasis(CellType type, const FacetPlace& at) {
  switch (type) {
  case CellType::Line2:
    return line(linear(at[0]));
  case CellType::Line3:
    return line(quadratic(at[0]));
  case CellType::Triangle3:
    return triangle(at, false);
  case CellType::Triangle6:
    return triangle(at, true);
  case CellType::Quadrilateral4:
    return product(linear(at[0]), linear(at[1]), 4);
  case CellType::Quadrilateral9:
    return product(quadratic(at[0]), quadratic(at[1]), 9);
  default:
    HARMOS_REQUIRE(false, "a facet is a line, a triangle or a quadrilateral");
  }
  return {};
}

FacetPlace facetCentre(CellType type) {
  return fem::shapeOf(type).isSimplex ? FacetPlace{1.0 / 3.0, 1.0 / 3.0} : FacetPlace{0.0, 0.0};
}

Facet::State Facet::at(const FacetPlace& place) const {
  State state;
  state.basis = facetBasis(surface_.facetType, place);
  for (std::size_t k = 0; k < size(); ++k)
    for (std::size_t d = 0; d < 3; ++d) {
      const double x = position(k)[d];
      state.position[d] += state.basis.values[k] * x;
      state.tangents[0][d] += state.basis.gradients[k][0] * x;
      state.tangents[1][d] += state.basis.gradients[k][1] * x;
    }
  const Point& t = state.tangents[0];
  state.areaNormal = surface_.dimension == 2 ? Point{t[1], -t[0], 0.0} : cross(t, state.tangents[1]);
  return state;
}

Point Facet::smoothNormal(const FacetBasis& basis) const {
  Point normal{};
  for (std::size_t k = 0; k < size(); ++k)
    normal = sum(normal, scaled(basis.values[k], surface_.normals[node(k)]));
  return scaled(1.0 / norm(normal), normal);
}

} // namespace Harmos::contact
