// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mass.hpp"

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>

namespace Harmos::fem {
namespace {

// ∫ρφ_i² of each node of a cell, scaled to its mass.
std::vector<double> massesOfCell(const CellIntegrator& cell, double density) {
  std::vector<double> masses(static_cast<std::size_t>(cell.basisSize()), 0.0);
  double squares = 0.0, size = 0.0;
  for (int q = 0; q < cell.points(); ++q) {
    size += cell.measure(q);
    for (int i = 0; i < cell.basisSize(); ++i) {
      const double square = cell.measure(q) * cell.value(i, q) * cell.value(i, q);
      masses[static_cast<std::size_t>(i)] += square;
      squares += square;
    }
  }
  for (double& mass : masses)
    mass *= density * size / squares;
  return masses;
}

// The nodes with mass that are nearest to a cell, by cells that share nodes.
std::vector<int> nearestWithMass(const Mesh& mesh, int cell, const std::vector<char>& massless) {
  const int width = mesh.nodesPerCell();
  std::vector<char> isReached(massless.size(), 0);
  for (int i = 0; i < width; ++i)
    isReached[static_cast<std::size_t>(mesh.cell(cell)[i])] = 1;
  std::vector<int> found;
  for (bool grows = true; grows && found.empty();) {
    grows = false;
    std::vector<char> next = isReached;
    for (int c = 0; c < mesh.numberOfCells(); ++c) {
      const int* nodes = mesh.cell(c);
      const auto touches = [&](int node) { return isReached[static_cast<std::size_t>(node)] != 0; };
      if (!std::any_of(nodes, nodes + width, touches) || std::all_of(nodes, nodes + width, touches))
        continue;
      grows = true;
      for (int i = 0; i < width; ++i)
        next[static_cast<std::size_t>(nodes[i])] = 1;
    }
    for (std::size_t node = 0; node < next.size(); ++node)
      if (next[node] != 0 && isReached[node] == 0 && massless[node] == 0)
        found.push_back(static_cast<int>(node));
    isReached.swap(next);
  }
  if (found.empty())
    throw InputError(
        "all nodes of a subdomain are in contact, and none is left that could have mass: use fewer "
        "subdomains, or a finer mesh");
  return found;
}

} // namespace

std::vector<double> lumpedMasses(const Mesh& mesh, const std::vector<double>& density,
                                 const std::vector<char>& massless) {
  const int degree = 2 * shapeOf(mesh.cellType).order * (shapeOf(mesh.cellType).isSimplex ? 1 : 2);
  const ReferenceElement element(mesh.cellType, std::max(degree, 2));
  CellIntegrator cell(mesh, element);
  std::vector<double> result(static_cast<std::size_t>(mesh.numberOfNodes()), 0.0);
  const auto isMassless = [&](int node) {
    return !massless.empty() && massless[static_cast<std::size_t>(node)] != 0;
  };
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    const auto region = static_cast<std::size_t>(mesh.region(c));
    const std::vector<double> masses = massesOfCell(cell, density.size() == 1 ? density[0] : density[region]);
    double all = 0.0, kept = 0.0;
    for (int i = 0; i < cell.basisSize(); ++i) {
      const double mass = masses[static_cast<std::size_t>(i)];
      all += mass;
      kept += isMassless(mesh.cell(c)[i]) ? 0.0 : mass;
    }
    if (kept > 0.0) {
      for (int i = 0; i < cell.basisSize(); ++i)
        if (const int node = mesh.cell(c)[i]; !isMassless(node))
          result[static_cast<std::size_t>(node)] += masses[static_cast<std::size_t>(i)] * all / kept;
    } else if (all > 0.0) {
      const std::vector<int> nearest = nearestWithMass(mesh, c, massless);
      for (int node : nearest)
        result[static_cast<std::size_t>(node)] += all / static_cast<double>(nearest.size());
    }
  }
  return result;
}

} // namespace Harmos::fem
