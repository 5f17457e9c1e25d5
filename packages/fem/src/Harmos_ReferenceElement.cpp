// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ReferenceElement.hpp"

#include "Harmos_Errors.hpp"

#include <Intrepid2_DefaultCubatureFactory.hpp>
#include <Intrepid2_HGRAD_QUAD_C1_FEM.hpp>
#include <Shards_CellTopology.hpp>

namespace Harmos::fem {
namespace {

using Device = Kokkos::DefaultHostExecutionSpace;
using View = Kokkos::DynRankView<double, Device>;

Quadrature makeQuadrature(const shards::CellTopology& topology, int degree) {
  const auto rule = Intrepid2::DefaultCubatureFactory::create<Device, double, double>(topology, degree);
  const int n = rule->getNumPoints();
  View points("points", n, 2), weights("weights", n);
  rule->getCubature(points, weights);
  Quadrature quadrature;
  for (int q = 0; q < n; ++q) {
    quadrature.points.push_back({points(q, 0), points(q, 1)});
    quadrature.weights.push_back(weights(q));
  }
  return quadrature;
}

View pointsView(const std::vector<std::array<double, 2>>& points) {
  View view("points", points.size(), 2);
  for (std::size_t q = 0; q < points.size(); ++q) {
    view(q, 0) = points[q][0];
    view(q, 1) = points[q][1];
  }
  return view;
}

} // namespace

Quadrature triangleQuadrature(int degree) {
  return makeQuadrature(shards::CellTopology(shards::getCellTopologyData<shards::Triangle<3>>()), degree);
}

ReferenceElement::ReferenceElement(CellType type, int degree) {
  HARMOS_REQUIRE(type == CellType::Quadrilateral4, "the cell type has no reference element");
  const Intrepid2::Basis_HGRAD_QUAD_C1_FEM<Device, double, double> basis;
  basisSize_ = static_cast<int>(basis.getCardinality());
  quadrature_ =
      makeQuadrature(shards::CellTopology(shards::getCellTopologyData<shards::Quadrilateral<4>>()), degree);
  const std::size_t n = quadrature_.points.size();
  const View points = pointsView(quadrature_.points);
  View values("values", basisSize_, n), gradients("gradients", basisSize_, n, 2);
  basis.getValues(values, points, Intrepid2::OPERATOR_VALUE);
  basis.getValues(gradients, points, Intrepid2::OPERATOR_GRAD);
  for (std::size_t q = 0; q < n; ++q)
    for (int i = 0; i < basisSize_; ++i) {
      values_.push_back(values(i, q));
      gradients_.push_back({gradients(i, q, 0), gradients(i, q, 1)});
    }
}

std::vector<std::vector<double>>
ReferenceElement::valuesAt(const std::vector<std::array<double, 2>>& points) const {
  const Intrepid2::Basis_HGRAD_QUAD_C1_FEM<Device, double, double> basis;
  View values("values", basisSize_, points.size());
  basis.getValues(values, pointsView(points), Intrepid2::OPERATOR_VALUE);
  std::vector<std::vector<double>> result(points.size(),
                                          std::vector<double>(static_cast<std::size_t>(basisSize_)));
  for (std::size_t q = 0; q < points.size(); ++q)
    for (int i = 0; i < basisSize_; ++i)
      result[q][static_cast<std::size_t>(i)] = values(i, q);
  return result;
}

} // namespace Harmos::fem
