// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ReferenceElement.hpp"

#include "Harmos_CellBasis.hpp"
#include "Harmos_Errors.hpp"

#include <Intrepid2_DefaultCubatureFactory.hpp>
#include <Intrepid2_HGRAD_HEX_C1_FEM.hpp>
#include <Intrepid2_HGRAD_HEX_C2_FEM.hpp>
#include <Intrepid2_HGRAD_LINE_C1_FEM.hpp>
#include <Intrepid2_HGRAD_LINE_Cn_FEM.hpp>
#include <Intrepid2_HGRAD_QUAD_C1_FEM.hpp>
#include <Intrepid2_HGRAD_QUAD_C2_FEM.hpp>
#include <Intrepid2_HGRAD_TET_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TET_C2_FEM.hpp>
#include <Intrepid2_HGRAD_TRI_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TRI_C2_FEM.hpp>
#include <Intrepid2_HGRAD_WEDGE_C1_FEM.hpp>
#include <Intrepid2_HGRAD_WEDGE_C2_FEM.hpp>
#include <Shards_CellTopology.hpp>

#include <algorithm>
#include <memory>
#include <numeric>

namespace Harmos::fem {
namespace {

using Device = Kokkos::DefaultHostExecutionSpace;
using View = Kokkos::DynRankView<double, Device>;
using Basis = Intrepid2::Basis<Device, double, double>;

std::shared_ptr<const Basis> basisOf(CellType type) {
  switch (wholeOf(type)) {
  case CellType::Line2:
    return std::make_shared<Intrepid2::Basis_HGRAD_LINE_C1_FEM<Device, double, double>>();
  case CellType::Line3:
    return std::make_shared<Intrepid2::Basis_HGRAD_LINE_Cn_FEM<Device, double, double>>(
        2, Intrepid2::POINTTYPE_EQUISPACED);
  case CellType::Triangle3:
    return std::make_shared<Intrepid2::Basis_HGRAD_TRI_C1_FEM<Device, double, double>>();
  case CellType::Triangle6:
    return std::make_shared<Intrepid2::Basis_HGRAD_TRI_C2_FEM<Device, double, double>>();
  case CellType::Quadrilateral4:
    return std::make_shared<Intrepid2::Basis_HGRAD_QUAD_C1_FEM<Device, double, double>>();
  case CellType::Quadrilateral9:
    return std::make_shared<Intrepid2::Basis_HGRAD_QUAD_C2_FEM<Device, double, double>>();
  case CellType::Tetrahedron4:
    return std::make_shared<Intrepid2::Basis_HGRAD_TET_C1_FEM<Device, double, double>>();
  case CellType::Tetrahedron10:
    return std::make_shared<Intrepid2::Basis_HGRAD_TET_C2_FEM<Device, double, double>>();
  case CellType::Hexahedron8:
    return std::make_shared<Intrepid2::Basis_HGRAD_HEX_C1_FEM<Device, double, double>>();
  case CellType::Hexahedron27:
    return std::make_shared<Intrepid2::Basis_HGRAD_HEX_C2_FEM<Device, double, double>>();
  case CellType::Wedge6:
    return std::make_shared<Intrepid2::Basis_HGRAD_WEDGE_C1_FEM<Device, double, double>>();
  case CellType::Wedge18:
    return std::make_shared<Intrepid2::Basis_HGRAD_WEDGE_C2_FEM<Device, double, double>>();
  default:
    break;
  }
  HARMOS_REQUIRE(false, "the cell type has no basis");
  return nullptr;
}

// Intrepid2's line elements of higher order number their nodes along the line in some versions; everything
// here has the corners first, as Shards does.
std::vector<int> order(CellType type, const Basis& basis) {
  std::vector<int> result(static_cast<std::size_t>(basis.getCardinality()));
  std::iota(result.begin(), result.end(), 0);
  if (type != CellType::Line3)
    return result;
  View x("coordinates", 3, 1);
  basis.getDofCoords(x);
  std::sort(result.begin(), result.end(), [&](int a, int b) { return x(a, 0) < x(b, 0); });
  return {result[0], result[2], result[1]};
}

std::size_t cardinalityOf(const Basis& basis) {
  return static_cast<std::size_t>(basis.getCardinality());
}

std::size_t dimensionOf(const Basis& basis) {
  return basis.getBaseCellTopology().getDimension();
}

View pointsView(const std::vector<Point>& points, std::size_t dimension) {
  View view("points", points.size(), dimension);
  for (std::size_t q = 0; q < points.size(); ++q)
    for (std::size_t d = 0; d < dimension; ++d)
      view(q, d) = points[q][d];
  return view;
}

std::vector<CellBasis> basesAt(CellType type, const std::vector<Point>& points) {
  std::vector<CellBasis> result(points.size());
  for (std::size_t q = 0; q < points.size(); ++q)
    cellBasis(shapeOf(type), points[q], result[q]);
  return result;
}

// Along the axis as many points as products of gradients need: two or three, unless the degree asks for more.
Quadrature quadratureOnWedge(int order, int degree) {
  const Quadrature triangle = quadratureOn(CellType::Triangle3, degree),
                   line = quadratureOn(CellType::Line2, std::max(degree, 2 * order + 1));
  Quadrature result;
  for (std::size_t z = 0; z < line.points.size(); ++z)
    for (std::size_t q = 0; q < triangle.points.size(); ++q) {
      result.points.push_back({triangle.points[q][0], triangle.points[q][1], line.points[z][0]});
      result.weights.push_back(triangle.weights[q] * line.weights[z]);
    }
  return result;
}

} // namespace

Quadrature quadratureOn(CellType type, int degree) {
  if (linearOf(type) == CellType::Wedge6)
    return quadratureOnWedge(type == CellType::Wedge6 ? 1 : 2, degree);
  const auto topology = basisOf(type)->getBaseCellTopology();
  const auto rule = Intrepid2::DefaultCubatureFactory::create<Device, double, double>(topology, degree);
  const auto n = static_cast<std::size_t>(rule->getNumPoints());
  const auto dimension = static_cast<std::size_t>(topology.getDimension());
  View points("points", n, dimension), weights("weights", n);
  rule->getCubature(points, weights);
  Quadrature quadrature;
  for (std::size_t q = 0; q < n; ++q) {
    Point point{};
    for (std::size_t d = 0; d < dimension; ++d)
      point[d] = points(q, d);
    quadrature.points.push_back(point);
    quadrature.weights.push_back(weights(q));
  }
  return quadrature;
}

std::vector<Point> nodeCoordinates(CellType type) {
  const std::shared_ptr<const Basis> basis = basisOf(type);
  const std::size_t dimension = dimensionOf(*basis);
  View coordinates("coordinates", cardinalityOf(*basis), dimension);
  basis->getDofCoords(coordinates);
  std::vector<Point> result;
  for (int i : order(type, *basis)) {
    Point point{};
    for (std::size_t d = 0; d < dimension; ++d)
      point[d] = coordinates(i, d);
    result.push_back(point);
  }
  if (wholeOf(type) != type)
    result.resize(type == CellType::Quadrilateral8 ? 8 : type == CellType::Wedge15 ? 15 : 20);
  return result;
}

std::vector<std::vector<double>> basisValues(CellType type, const std::vector<Point>& points) {
  if (wholeOf(type) != type) {
    std::vector<std::vector<double>> result;
    for (const CellBasis& at : basesAt(type, points))
      result.emplace_back(at.values.begin(), at.values.begin() + shapeOf(type).nodes);
    return result;
  }
  const std::shared_ptr<const Basis> basis = basisOf(type);
  View values("values", cardinalityOf(*basis), points.size());
  basis->getValues(values, pointsView(points, dimensionOf(*basis)), Intrepid2::OPERATOR_VALUE);
  std::vector<std::vector<double>> result(points.size());
  for (std::size_t q = 0; q < points.size(); ++q)
    for (int i : order(type, *basis))
      result[q].push_back(values(i, q));
  return result;
}

std::vector<std::vector<Point>> basisGradients(CellType type, const std::vector<Point>& points) {
  if (wholeOf(type) != type) {
    std::vector<std::vector<Point>> result;
    for (const CellBasis& at : basesAt(type, points))
      result.emplace_back(at.gradients.begin(), at.gradients.begin() + shapeOf(type).nodes);
    return result;
  }
  const std::shared_ptr<const Basis> basis = basisOf(type);
  const std::size_t dimension = dimensionOf(*basis);
  View gradients("gradients", cardinalityOf(*basis), points.size(), dimension);
  basis->getValues(gradients, pointsView(points, dimension), Intrepid2::OPERATOR_GRAD);
  std::vector<std::vector<Point>> result(points.size());
  for (std::size_t q = 0; q < points.size(); ++q)
    for (int i : order(type, *basis)) {
      Point gradient{};
      for (std::size_t d = 0; d < dimension; ++d)
        gradient[d] = gradients(i, q, d);
      result[q].push_back(gradient);
    }
  return result;
}

ReferenceElement::ReferenceElement(CellType type, int degree) : quadrature_(quadratureOn(type, degree)) {
  for (const std::vector<double>& row : basisValues(type, quadrature_.points)) {
    basisSize_ = static_cast<int>(row.size());
    values_.insert(values_.end(), row.begin(), row.end());
  }
  for (const std::vector<Point>& row : basisGradients(type, quadrature_.points))
    gradients_.insert(gradients_.end(), row.begin(), row.end());
}

} // namespace Harmos::fem
