// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Loads.hpp"

#include "Harmos_CellIntegrator.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace Harmos::fem {
namespace {

// Products of a basis function and a load that varies as much as the basis, on affine cells.
int loadDegree(const CellShape& shape) {
  return shape.isSimplex ? (shape.order == 1 ? 3 : 5) : (shape.order == 1 ? 4 : 6);
}

// f_i += ∫ values φ_i
void addLoad(const CellIntegrator& cell, const int* nodes, std::size_t dimension, int q, const Point& density,
             std::vector<double>& f) {
  for (int i = 0; i < cell.basisSize(); ++i)
    for (std::size_t d = 0; d < dimension; ++d)
      f[static_cast<std::size_t>(nodes[i]) * dimension + d] +=
          cell.measure(q) * cell.value(i, q) * density[d];
}

} // namespace

namespace {

// @param displacement or null.
std::vector<double> bodyForce(const Mesh& mesh, const Point& anchor, const std::vector<double>* displacement,
                              const VectorField& force, Integration integration) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const bool isReduced = integration == Integration::Reduced && shape.isSerendipity;
  const ReferenceElement element(mesh.cellType,
                                 isReduced ? stiffnessDegree(mesh.cellType, integration) : loadDegree(shape));
  CellIntegrator cell(mesh, element);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()) * dimension, 0.0);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (int q = 0; q < cell.points(); ++q) {
      Point x = cell.position(q);
      for (std::size_t d = 0; d < 3; ++d)
        x[d] += anchor[d];
      for (int i = 0; i < cell.basisSize() && displacement != nullptr; ++i)
        for (std::size_t d = 0; d < dimension; ++d)
          x[d] +=
              cell.value(i, q) * (*displacement)[static_cast<std::size_t>(mesh.cell(c)[i]) * dimension + d];
      addLoad(cell, mesh.cell(c), dimension, q, force(x), f);
    }
  }
  return f;
}

} // namespace

std::vector<double> assembleBodyForce(const Mesh& mesh, const Point& anchor, const VectorField& force,
                                      Integration integration) {
  return bodyForce(mesh, anchor, nullptr, force, integration);
}

std::vector<double> assembleMovedBodyForce(const Mesh& mesh, const Point& anchor,
                                           const std::vector<double>& displacement, const VectorField& force,
                                           Integration integration) {
  return bodyForce(mesh, anchor, &displacement, force, integration);
}

void visitSides(const Mesh& mesh, const std::vector<Side>& sides, int degree,
                const std::function<void(const SidePoint&)>& visit) {
  std::map<CellType, ReferenceElement> elements;
  for (CellType type : shapeOf(mesh.cellType).sideTypes)
    elements.try_emplace(type, type, degree);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  for (const Side& side : sides) {
    const ReferenceElement& element = elements.at(mesh.typeOf(side));
    SidePoint point;
    point.nodes = mesh.nodesOf(side);
    point.values.resize(point.nodes.size());
    for (int q = 0; q < element.points(); ++q) {
      Point normal{};
      std::array<Point, 2> tangent{};
      point.position = {};
      for (std::size_t i = 0; i < point.nodes.size(); ++i) {
        const Point place = mesh.local(point.nodes[i]);
        const Point& g = element.gradient(static_cast<int>(i), q);
        point.values[i] = element.value(static_cast<int>(i), q);
        for (std::size_t d = 0; d < 3; ++d) {
          point.position[d] += point.values[i] * place[d];
          tangent[0][d] += g[0] * place[d];
          tangent[1][d] += g[1] * place[d];
        }
      }
      if (dimension == 2)
        normal = {tangent[0][1], -tangent[0][0], 0.0};
      else
        for (std::size_t d = 0; d < 3; ++d)
          normal[d] = tangent[0][(d + 1) % 3] * tangent[1][(d + 2) % 3] -
                      tangent[0][(d + 2) % 3] * tangent[1][(d + 1) % 3];
      const double area = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
      for (std::size_t d = 0; d < 3; ++d)
        point.normal[d] = normal[d] / area;
      point.measure = element.weight(q) * area * mesh.around(side.cell, point.position);
      visit(point);
    }
  }
}

std::vector<double> assembleTraction(const Mesh& mesh, const Point& anchor, const std::vector<Side>& sides,
                                     const Traction& traction) {
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> f(static_cast<std::size_t>(mesh.numberOfNodes()) * dimension, 0.0);
  int degree = 0;
  for (CellType type : shapeOf(mesh.cellType).sideTypes)
    degree = std::max(degree, loadDegree(shapeOf(type)));
  visitSides(mesh, sides, degree, [&](const SidePoint& point) {
    Point x = anchor;
    for (std::size_t d = 0; d < 3; ++d)
      x[d] += point.position[d];
    const Point t = traction(x, point.normal);
    for (std::size_t i = 0; i < point.nodes.size(); ++i)
      for (std::size_t d = 0; d < dimension; ++d)
        f[static_cast<std::size_t>(point.nodes[i]) * dimension + d] += point.measure * point.values[i] * t[d];
  });
  return f;
}

} // namespace Harmos::fem
