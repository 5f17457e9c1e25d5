// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressSums.hpp"

#include "Harmos_CellStress.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace Harmos::fem {
namespace {

// Functions of a coordinate relative to a point of the cell: 1, or 1, x, y(, z).
int polynomials(int degree, int dimension) {
  return degree == 0 ? 1 : 1 + dimension;
}

// What values at the points of a cell contribute to the sums at its nodes: those of the polynomial of least
// squares, times the size of the cell. @param m functions of the polynomial.
void findWeights(const Mesh& mesh, const CellIntegrator& cell, int number, int m,
                 std::vector<double>& toNodes) {
  const auto functions = static_cast<std::size_t>(m), points = static_cast<std::size_t>(cell.points()),
             size = static_cast<std::size_t>(cell.basisSize());
  const int* members = mesh.cell(number);
  const double area = cell.size();
  if (m == 1) {
    // Functions of the first order need no more than a mean.
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t q = 0; q < points; ++q)
        toNodes[i * points + q] = cell.measure(static_cast<int>(q));
  } else {
    // Values at points → polynomial of least squares → its values at the nodes, times the size of the cell.
    const double length = std::pow(area, 1.0 / static_cast<double>(mesh.dimension()));
    const Point origin = mesh.local(members[0]);
    const auto basis = [&](const Point& x, std::size_t a) {
      return a == 0 ? 1.0 : (x[a - 1] - origin[a - 1]) / length;
    };
    std::vector<double> gram(functions * functions, 0.0), moments(functions * points);
    for (std::size_t q = 0; q < points; ++q) {
      const Point x = cell.position(static_cast<int>(q));
      for (std::size_t a = 0; a < functions; ++a) {
        const double weight = cell.measure(static_cast<int>(q)) * basis(x, a);
        moments[q * functions + a] = weight;
        for (std::size_t b = 0; b < functions; ++b)
          gram[a * functions + b] += weight * basis(x, b);
      }
    }
    solveSmall(m, gram, static_cast<int>(points), moments.data());
    for (std::size_t i = 0; i < size; ++i) {
      const Point x = mesh.local(members[i]);
      for (std::size_t q = 0; q < points; ++q) {
        double sum = 0.0;
        for (std::size_t a = 0; a < functions; ++a)
          sum += basis(x, a) * moments[q * functions + a];
        toNodes[i * points + q] = area * sum;
      }
    }
  }
}

template<std::size_t Entries>
std::vector<StressSums> sumsOf(const Mesh& mesh, const Elasticity* elasticity,
                               const std::vector<NodalSolution>& solutions) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const bool hasStates = elasticity != nullptr && MaterialLaws(*elasticity).stateSize() > 0;
  const int degree = samplingDegree(mesh, elasticity);
  const ReferenceElement element(mesh.cellType, degree);
  CellIntegrator cell(mesh, element);
  CellStress<Entries> stress(mesh, element, cell, elasticity);
  const auto nodes = static_cast<std::size_t>(mesh.numberOfNodes());
  const int m = polynomials(shape.order - 1, mesh.dimension());
  const auto points = static_cast<std::size_t>(cell.points()),
             size = static_cast<std::size_t>(cell.basisSize());
  std::vector<StressSums> all(solutions.size(), {std::vector<Voigt>(nodes), std::vector<double>(nodes, 0.0),
                                                 std::vector<double>(hasStates ? nodes : 0, 0.0)});
  std::vector<double> toNodes(size * points);
  std::vector<Stress<Entries>> values(points);
  std::vector<double> shown(points);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const int* members = mesh.cell(c);
    const double area = cell.size();
    findWeights(mesh, cell, c, m, toNodes);
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      for (std::size_t q = 0; q < points; ++q)
        values[q] = stress.at(static_cast<int>(q));
      for (std::size_t q = 0; q < points && hasStates; ++q)
        shown[q] = stress.shownAt(static_cast<int>(q));
      StressSums& sums = all[k];
      for (std::size_t i = 0; i < size; ++i) {
        const auto node = static_cast<std::size_t>(members[i]);
        sums.size[node] += area;
        Voigt& weighted = sums.weighted[node];
        for (std::size_t q = 0; q < points; ++q)
          for (std::size_t r = 0; r < Entries; ++r)
            weighted[r] += toNodes[i * points + q] * values[q][r];
        for (std::size_t q = 0; q < points && hasStates; ++q)
          sums.states[node] += toNodes[i * points + q] * shown[q];
      }
    }
  }
  return all;
}

} // namespace

std::vector<StressSums> stressSums(const Mesh& mesh, const Elasticity& elasticity,
                                   const std::vector<NodalSolution>& solutions) {
  return sumsOf<elasticEntries>(mesh, &elasticity, solutions);
}

std::vector<std::vector<Voigt>> cellStresses(const Mesh& mesh, const Elasticity& elasticity,
                                             const std::vector<NodalSolution>& solutions) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  CellIntegrator cell(mesh, element);
  CellStress<elasticEntries> stress(mesh, element, cell, &elasticity);
  std::vector<std::vector<Voigt>> means(solutions.size(),
                                        std::vector<Voigt>(static_cast<std::size_t>(mesh.numberOfCells())));
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      Voigt& mean = means[k][static_cast<std::size_t>(c)];
      for (int q = 0; q < cell.points(); ++q) {
        const Voigt at = stress.at(q);
        for (std::size_t r = 0; r < at.size(); ++r)
          mean[r] += cell.measure(q) / cell.size() * at[r];
      }
    }
  }
  return means;
}

std::vector<StressSums> fluxSums(const Mesh& mesh, const std::vector<NodalSolution>& solutions) {
  return sumsOf<membraneEntries>(mesh, nullptr, solutions);
}

} // namespace Harmos::fem
