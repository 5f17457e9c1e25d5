// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mass.hpp"

#include "Harmos_CellIntegrator.hpp"
#include "Harmos_Errors.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>

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

// 1, x and x xᵀ of a node, by its place in the box around all nodes, from −1 to 1.
class Moments {
 public:
  explicit Moments(const Mesh& mesh) : mesh_(mesh), components_(static_cast<std::size_t>(mesh.dimension())) {
    for (std::size_t d = 0; d < components_; ++d) {
      double least = mesh.coordinates[d], most = least;
      for (std::size_t k = d; k < mesh.coordinates.size(); k += components_) {
        least = std::min(least, mesh.coordinates[k]);
        most = std::max(most, mesh.coordinates[k]);
      }
      centre_.push_back(0.5 * (least + most));
      half_.push_back(most > least ? 0.5 * (most - least) : 1.0);
    }
  }
  // Up to an order.
  std::vector<double> at(std::size_t node, int order) const {
    std::vector<double> x, result = {1.0};
    for (std::size_t d = 0; d < components_; ++d)
      x.push_back((mesh_.coordinates[node * components_ + d] - centre_[d]) / half_[d]);
    result.insert(result.end(), x.begin(), x.end());
    for (std::size_t a = 0; a < components_ && order > 1; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        result.push_back(x[a] * x[b]);
    return result;
  }

 private:
  const Mesh& mesh_;
  std::size_t components_;
  std::vector<double> centre_, half_;
};

// m ← m(1 + p(x)), p the polynomial of an order by which moments are those of other masses: the least change,
// in the mean square over the mass. @return nothing where moments do not decide p, or where masses come to
// less than a share of what they were.
std::vector<double> withMomentsOf(const Mesh& mesh, const std::vector<double>& others,
                                  const std::vector<double>& masses, int order) {
  const Moments moments(mesh);
  const std::size_t n = moments.at(0, order).size();
  std::vector<double> matrix(n * n, 0.0), change(n, 0.0);
  double all = 0.0;
  for (std::size_t node = 0; node < masses.size(); ++node) {
    const std::vector<double> values = moments.at(node, order);
    for (std::size_t a = 0; a < n; ++a) {
      change[a] += (others[node] - masses[node]) * values[a];
      for (std::size_t b = 0; b < n; ++b)
        matrix[a * n + b] += masses[node] * values[a] * values[b];
    }
    all += masses[node];
  }
  constexpr double decided = 1e-8, leastShare = 0.25;
  for (std::size_t a = 0; a < n; ++a)
    matrix[a * n + a] -= decided * all; // positive definite by as much
  int info = 0;
  const auto size = static_cast<int>(n);
  Teuchos::LAPACK<int, double> lapack;
  std::vector<double> factor = matrix;
  lapack.POTRF('L', size, factor.data(), size, &info);
  if (info != 0)
    return {};
  for (std::size_t a = 0; a < n; ++a)
    matrix[a * n + a] += decided * all;
  lapack.POSV('L', size, 1, matrix.data(), size, change.data(), size, &info);
  std::vector<double> result = masses;
  for (std::size_t node = 0; node < masses.size(); ++node) {
    const std::vector<double> values = moments.at(node, order);
    double share = 1.0;
    for (std::size_t a = 0; a < n; ++a)
      share += change[a] * values[a];
    if (masses[node] > 0.0 && !(share >= leastShare))
      return {};
    result[node] *= share;
  }
  return result;
}

// With the centre and the moments of inertia of other masses, or the centre alone, where that can be.
std::vector<double> withMomentsOf(const Mesh& mesh, const std::vector<double>& others,
                                  const std::vector<double>& masses) {
  for (int order : {2, 1})
    if (std::vector<double> result = withMomentsOf(mesh, others, masses, order); !result.empty())
      return result;
  return masses;
}

} // namespace

std::vector<double> lumpedMasses(const Mesh& mesh, const std::vector<double>& density,
                                 const std::vector<char>& massless) {
  const int degree = 2 * shapeOf(mesh.cellType).order * (shapeOf(mesh.cellType).isSimplex ? 1 : 2);
  const ReferenceElement element(mesh.cellType, std::max(degree, 2));
  CellIntegrator cell(mesh, element);
  std::vector<double> result(static_cast<std::size_t>(mesh.numberOfNodes()), 0.0), ofAll = result;
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
      ofAll[static_cast<std::size_t>(mesh.cell(c)[i])] += mass;
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
  return massless.empty() ? result : withMomentsOf(mesh, ofAll, result);
}

} // namespace Harmos::fem
