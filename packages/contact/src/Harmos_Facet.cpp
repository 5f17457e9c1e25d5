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

// Quadrilateral of eight nodes, see fem::cellBasis(): 1 − x² and the linear functions of its directions.
FacetBasis serendipity(const FacetPlace& at) {
  const std::array<Line, 2> linears = {linear(at[0]), linear(at[1])};
  const std::array<Line, 2> squares = {quadratic(at[0]), quadratic(at[1])};
  constexpr std::array<double, 2> ends = {-1.0, 1.0};
  FacetBasis basis;
  for (std::size_t k = 0; k < 8; ++k) {
    const auto [i, j] = tensor[k];
    const Line &x = i == 2 ? squares[0] : linears[0], &y = j == 2 ? squares[1] : linears[1];
    basis.values[k] = x.values[i] * y.values[j];
    basis.gradients[k] = {x.slopes[i] * y.values[j], x.values[i] * y.slopes[j]};
    if (k >= 4)
      continue;
    const double product = basis.values[k], rest = ends[i] * at[0] + ends[j] * at[1] - 1.0;
    basis.values[k] *= rest;
    basis.gradients[k] = {basis.gradients[k][0] * rest + product * ends[i],
                          basis.gradients[k][1] * rest + product * ends[j]};
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
  case CellType::Quadrilateral8:
    return serendipity(at);
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

Carriers::Carriers(CellType type, const std::array<double, 4>& shares, bool isPartial)
    : size_(static_cast<std::size_t>(fem::shapeOf(type).nodes)),
      corners_(static_cast<std::size_t>(fem::shapeOf(type).corners)),
      edges_(size_ == corners_ ? 0
             : corners_ == 2   ? 1
                               : corners_),
      shares_(shares) {
  if (!isPartial)
    return;
  const double share = partialShare(type);
  toCorner_ = share * share;
  toEdge_ = share * (1.0 - 2.0 * share);
}

Carriers::Carriers(CellType type, bool isAxisymmetric) : Carriers(type, {}, false) {
  shares_.fill(usualShare(type, isAxisymmetric));
}

// The corners that an edge node lies between.
std::array<std::size_t, 2> Carriers::endsOf(std::size_t edgeNode) const {
  if (corners_ == 2) // the middle of a line
    return {0, 1};
  return {edgeNode - corners_, (edgeNode - corners_ + 1) % corners_};
}

std::array<double, maxFacetNodes> Carriers::values(const std::array<double, maxFacetNodes>& lagrange) const {
  std::array<double, maxFacetNodes> result = lagrange;
  for (std::size_t e = corners_; e < corners_ + edges_; ++e) {
    result[e] *= 1.0 - 2.0 * share(e);
    for (std::size_t k : endsOf(e))
      result[k] += share(e) * lagrange[e];
  }
  if (size_ == corners_ + edges_)
    return result;
  const double middle = lagrange[size_ - 1];
  for (std::size_t k = 0; k < size_ - 1; ++k)
    result[k] += (k < corners_ ? toCorner_ : toEdge_) * middle;
  result[size_ - 1] *= 1.0 - 4.0 * (toCorner_ + toEdge_);
  return result;
}

std::vector<std::pair<std::size_t, double>> Carriers::coefficient(std::size_t k) const {
  if (k < corners_)
    return {{k, 1.0}};
  if (k < corners_ + edges_) {
    const double s = share(k), whole = 1.0 / (1.0 - 2.0 * s);
    if (s == 0.0)
      return {{k, 1.0}};
    return {{k, whole}, {endsOf(k)[0], -s * whole}, {endsOf(k)[1], -s * whole}};
  }
  if (toCorner_ == 0.0)
    return {{k, 1.0}};
  // What is left in the middle when corners and edges have had their parts.
  std::array<double, maxFacetNodes> weights{};
  weights[k] = 1.0;
  for (std::size_t i = 0; i < k; ++i)
    for (const auto& [node, weight] : coefficient(i))
      weights[node] -= (i < corners_ ? toCorner_ : toEdge_) * weight;
  std::vector<std::pair<std::size_t, double>> terms;
  for (std::size_t i = 0; i < size_; ++i)
    terms.emplace_back(i, weights[i] / (1.0 - 4.0 * (toCorner_ + toEdge_)));
  return terms;
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
  state.measure = norm(state.areaNormal);
  if (surface_.isAxisymmetric) {
    constexpr double turn = 6.283185307179586;
    state.measure *= turn * state.position[0];
  }
  return state;
}

bool facesAt(const Facet& facet, std::size_t node, const Point& direction) {
  const Point& place = facet.shape().nodeCoordinates[node];
  const Point normal = facet.at({place[0], place[1]}).areaNormal;
  return dot(normal, direction) > leastFacing * norm(normal);
}

FacetIntegrals integralsOn(const Facet& facet, const fem::Quadrature& rule) {
  FacetIntegrals result;
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const Facet::State state = facet.at({rule.points[q][0], rule.points[q][1]});
    const double weight = rule.weights[q] * state.measure;
    result.area += weight;
    for (std::size_t k = 0; k < facet.size(); ++k)
      result.ofNodes[k] += weight * state.basis.values[k];
  }
  return result;
}

Point Facet::smoothNormal(const FacetBasis& basis) const {
  Point normal{};
  for (std::size_t k = 0; k < size(); ++k)
    normal = sum(normal, scaled(basis.values[k], surface_.normals[node(k)]));
  return scaled(1.0 / norm(normal), normal);
}

} // namespace Harmos::contact
