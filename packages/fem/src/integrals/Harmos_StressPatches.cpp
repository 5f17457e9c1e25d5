// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressPatches.hpp"

#include "Harmos_CellStress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::fem {
namespace {

// Functions of a place relative to a node: up to the order of the elements.
class PatchBasis {
 public:
  PatchBasis(int order, int dimension)
      : dimension_(dimension),
        size_(order == 1       ? 1
              : dimension == 2 ? 6
                               : 10),
        values_(10, 1.0) {}

  int size() const { return size_; }
  const std::vector<double>& at(const Point& x) {
    if (size_ == 1)
      return values_;
    std::size_t next = 1;
    const auto d = static_cast<std::size_t>(dimension_);
    for (std::size_t a = 0; a < d; ++a)
      values_[next++] = x[a];
    for (std::size_t a = 0; a < d; ++a)
      for (std::size_t b = 0; b <= a; ++b)
        values_[next++] = x[a] * x[b];
    return values_;
  }
  // Of the second degree, and no constant.
  bool isQuadratic(int function) const { return function > dimension_; }

 private:
  int dimension_, size_;
  std::vector<double> values_;
};

Point relative(const Point& x, const Point& origin) {
  return {x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]};
}

// Places of the patches of a mesh, and which of them each corner of each cell has.
struct Places {
  std::vector<StressPatches::Place> places;
  std::vector<std::size_t> ofCorners; // corners a cell
};
Places placesOf(const Mesh& mesh) {
  const auto corners = static_cast<std::size_t>(shapeOf(mesh.cellType).corners);
  const auto cells = static_cast<std::size_t>(mesh.numberOfCells());
  const auto keyOf = [&](std::size_t k) {
    const int cell = static_cast<int>(k / corners);
    return std::make_pair(mesh.cell(cell)[k % corners], mesh.region(cell));
  };
  std::vector<std::size_t> order(cells * corners);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return keyOf(a) < keyOf(b); });
  Places result;
  result.ofCorners.resize(order.size());
  for (std::size_t k : order) {
    const auto [node, region] = keyOf(k);
    if (result.places.empty() || result.places.back().node != node || result.places.back().region != region)
      result.places.push_back({node, region});
    result.ofCorners[k] = result.places.size() - 1;
  }
  return result;
}

template<std::size_t Entries>
std::vector<StressPatches> patchesOf(const Mesh& mesh, const Elasticity* elasticity,
                                     const std::vector<NodalSolution>& solutions) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const ReferenceElement element(mesh.cellType, samplingDegree(mesh, elasticity));
  CellIntegrator cell(mesh, element);
  CellStress<Entries> stress(mesh, element, cell, elasticity);
  PatchBasis basis(shape.order, mesh.dimension());
  const Places places = placesOf(mesh);
  const auto m = static_cast<std::size_t>(basis.size()), corners = static_cast<std::size_t>(shape.corners),
             points = static_cast<std::size_t>(cell.points());
  std::vector<double> gram(places.places.size() * m * m, 0.0);
  std::vector<StressPatches> all(
      solutions.size(),
      {places.places, basis.size(), {}, std::vector<double>(places.places.size() * m * 6, 0.0)});
  std::vector<double> values(corners * points * m); // of the functions, weighted
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const std::size_t* patch = places.ofCorners.data() + static_cast<std::size_t>(c) * corners;
    for (std::size_t i = 0; i < corners; ++i)
      for (std::size_t q = 0; q < points; ++q) {
        const std::vector<double>& at =
            basis.at(relative(cell.position(static_cast<int>(q)), mesh.local(mesh.cell(c)[i])));
        const double weight = m == 1 ? cell.measure(static_cast<int>(q)) : 1.0;
        for (std::size_t a = 0; a < m; ++a) {
          values[(i * points + q) * m + a] = weight * at[a];
          for (std::size_t b = 0; b < m; ++b)
            gram[(patch[i] * m + a) * m + b] += weight * at[a] * at[b];
        }
      }
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      for (std::size_t q = 0; q < points; ++q) {
        const Stress<Entries> sigma = stress.at(static_cast<int>(q));
        for (std::size_t i = 0; i < corners; ++i) {
          double* moments = all[k].moments.data() + patch[i] * m * 6;
          for (std::size_t a = 0; a < m; ++a)
            for (std::size_t r = 0; r < Entries; ++r)
              moments[a * 6 + r] += values[(i * points + q) * m + a] * sigma[r];
        }
      }
    }
  }
  for (StressPatches& patches : all)
    patches.gram = gram;
  return all;
}

// Polynomials of least squares, m × 6 of each place. Functions are scaled to equal sizes over the points;
// what these do not decide, in the patches at boundaries and corners, is kept small by a little weight, of
// the second degree more than of the first.
std::vector<double> polynomialsOf(const StressPatches& patches, const PatchBasis& basis) {
  constexpr double linear = 1e-7, quadratic = 1e-3;
  const auto m = static_cast<std::size_t>(patches.functions);
  std::vector<double> result = patches.moments;
  std::vector<double> matrix(m * m), right(6 * m), scale(m);
  for (std::size_t p = 0; p < patches.places.size(); ++p) {
    const double* gram = patches.gram.data() + p * m * m;
    double* values = result.data() + p * m * 6;
    for (std::size_t a = 0; a < m; ++a)
      scale[a] = gram[a * m + a] > 0.0 ? 1.0 / std::sqrt(gram[a * m + a]) : 1.0;
    for (std::size_t a = 0; a < m; ++a) {
      for (std::size_t b = 0; b < m; ++b)
        matrix[a * m + b] = scale[a] * gram[a * m + b] * scale[b];
      if (a > 0)
        matrix[a * m + a] += basis.isQuadratic(static_cast<int>(a)) ? quadratic : linear;
      for (std::size_t r = 0; r < 6; ++r)
        right[r * m + a] = scale[a] * values[a * 6 + r];
    }
    solveSmall(patches.functions, matrix, 6, right.data());
    for (std::size_t a = 0; a < m; ++a)
      for (std::size_t r = 0; r < 6; ++r)
        values[a * 6 + r] = scale[a] * right[r * m + a];
  }
  return result;
}

// Of each node of a cell the corners nearest to it on the reference cell.
std::vector<std::vector<std::size_t>> nearestCorners(const CellShape& shape) {
  std::vector<std::vector<std::size_t>> result;
  for (const Point& x : shape.nodeCoordinates) {
    std::vector<double> squares;
    for (std::size_t i = 0; i < static_cast<std::size_t>(shape.corners); ++i) {
      const Point d = relative(shape.nodeCoordinates[i], x);
      squares.push_back(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    const double least = *std::min_element(squares.begin(), squares.end());
    std::vector<std::size_t>& nearest = result.emplace_back();
    for (std::size_t i = 0; i < squares.size(); ++i)
      if (squares[i] < least + 1e-9)
        nearest.push_back(i);
  }
  return result;
}

// C⁻¹ of each region, of the solid: with σ_zz among the stresses it is that of both cross-sections too.
std::vector<VoigtMatrix> compliances(const Elasticity& elasticity) {
  std::vector<VoigtMatrix> result;
  for (const Material& material : elasticity.materials) {
    const VoigtMatrix c = material.stiffness(Kinematics::Solid);
    std::vector<double> matrix, inverse(36, 0.0);
    for (std::size_t r = 0; r < 6; ++r) {
      matrix.insert(matrix.end(), c[r].begin(), c[r].end());
      inverse[7 * r] = 1.0;
    }
    solveSmall(6, matrix, 6, inverse.data());
    VoigtMatrix compliance;
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t k = 0; k < 6; ++k)
        compliance[r][k] = inverse[6 * r + k];
    result.push_back(compliance);
  }
  return result;
}

// σ : C⁻¹ : σ; without C⁻¹ |σ|².
template<std::size_t Entries>
double energyOf(const Stress<Entries>& s, const VoigtMatrix* inverse) {
  double sum = 0.0;
  for (std::size_t r = 0; r < Entries; ++r)
    if (inverse == nullptr)
      sum += s[r] * s[r];
    else
      for (std::size_t k = 0; k < Entries; ++k)
        sum += s[r] * (*inverse)[r][k] * s[k];
  return sum;
}

// Recovered stresses at the nodes of a cell.
template<std::size_t Entries>
class NodalStress {
 public:
  NodalStress(const Mesh& mesh, const StressPatches& patches)
      : mesh_(mesh),
        basis_(shapeOf(mesh.cellType).order, mesh.dimension()),
        polynomials_(polynomialsOf(patches, basis_)) {}

  // @param patches of the corners of the cell. @param nearest see nearestCorners().
  void find(int cell, const std::size_t* patches, const std::vector<std::vector<std::size_t>>& nearest,
            std::vector<Stress<Entries>>& nodal) {
    const auto m = static_cast<std::size_t>(basis_.size());
    const int* members = mesh_.cell(cell);
    for (std::size_t i = 0; i < nodal.size(); ++i) {
      nodal[i] = {};
      for (std::size_t corner : nearest[i]) {
        const std::vector<double>& at =
            basis_.at(relative(mesh_.local(members[i]), mesh_.local(members[corner])));
        const double* polynomial = polynomials_.data() + patches[corner] * m * 6;
        for (std::size_t a = 0; a < m; ++a)
          for (std::size_t r = 0; r < Entries; ++r)
            nodal[i][r] += at[a] * polynomial[a * 6 + r] / static_cast<double>(nearest[i].size());
      }
    }
  }

 private:
  const Mesh& mesh_;
  PatchBasis basis_;
  std::vector<double> polynomials_;
};

template<std::size_t Entries>
RecoveryError errorOf(const Mesh& mesh, const Elasticity* elasticity,
                      const std::vector<NodalSolution>& solutions,
                      const std::vector<const StressPatches*>& patches) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const ReferenceElement element(
      mesh.cellType,
      stiffnessDegree(mesh, elasticity != nullptr ? elasticity->integration : Integration::Full));
  CellIntegrator cell(mesh, element);
  CellStress<Entries> stress(mesh, element, cell, elasticity);
  const std::vector<VoigtMatrix> compliance =
      elasticity != nullptr ? compliances(*elasticity) : std::vector<VoigtMatrix>{};
  const Places places = placesOf(mesh);
  const std::vector<std::vector<std::size_t>> nearest = nearestCorners(shape);
  std::vector<NodalStress<Entries>> recovered;
  for (const StressPatches* of : patches)
    recovered.emplace_back(mesh, *of);
  RecoveryError result;
  result.cells.assign(solutions.size(),
                      std::vector<double>(static_cast<std::size_t>(mesh.numberOfCells()), 0.0));
  const auto size = static_cast<std::size_t>(cell.basisSize()),
             points = static_cast<std::size_t>(cell.points());
  std::vector<double> basis; // the same in all cells
  for (int q = 0; q < cell.points(); ++q)
    for (int i = 0; i < cell.basisSize(); ++i)
      basis.push_back(cell.value(i, q));
  std::vector<Stress<Entries>> nodal(size);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const VoigtMatrix* inverse = elasticity != nullptr ? &stiffnessOf(compliance, mesh.region(c)) : nullptr;
    const std::size_t* patch =
        places.ofCorners.data() + static_cast<std::size_t>(c) * static_cast<std::size_t>(shape.corners);
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      recovered[k].find(c, patch, nearest, nodal);
      double error = 0.0;
      for (std::size_t q = 0; q < points; ++q) {
        const double measure = cell.measure(static_cast<int>(q));
        Stress<Entries> difference = stress.at(static_cast<int>(q));
        result.energy += measure * energyOf(difference, inverse);
        for (std::size_t i = 0; i < size; ++i)
          for (std::size_t r = 0; r < Entries; ++r)
            difference[r] -= basis[q * size + i] * nodal[i][r];
        error += measure * energyOf(difference, inverse);
      }
      result.error += error;
      result.cells[k][static_cast<std::size_t>(c)] = error;
    }
  }
  return result;
}

} // namespace

std::vector<StressPatches> stressPatches(const Mesh& mesh, const Elasticity& elasticity,
                                         const std::vector<NodalSolution>& solutions) {
  return patchesOf<elasticEntries>(mesh, &elasticity, solutions);
}

std::vector<StressPatches> fluxPatches(const Mesh& mesh, const std::vector<NodalSolution>& solutions) {
  return patchesOf<membraneEntries>(mesh, nullptr, solutions);
}

RecoveryError recoveryError(const Mesh& mesh, const Elasticity& elasticity,
                            const std::vector<NodalSolution>& solutions,
                            const std::vector<const StressPatches*>& patches) {
  return errorOf<elasticEntries>(mesh, &elasticity, solutions, patches);
}

RecoveryError fluxRecoveryError(const Mesh& mesh, const std::vector<NodalSolution>& solutions,
                                const std::vector<const StressPatches*>& patches) {
  return errorOf<membraneEntries>(mesh, nullptr, solutions, patches);
}

} // namespace Harmos::fem
