// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressSums.hpp"

#include "Harmos_StrainOperator.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>

namespace Harmos::fem {
namespace {

// Functions of a coordinate relative to a point of the cell: 1, or 1, x, y(, z).
int polynomials(int degree, int dimension) {
  return degree == 0 ? 1 : 1 + dimension;
}

// Stresses of an elastic mesh, or the gradient of a membrane in the first two entries, cell after cell.
class CellStress {
 public:
  CellStress(const Mesh& mesh, const CellIntegrator& cell, const Elasticity* elasticity)
      : mesh_(mesh), cell_(cell) {
    if (elasticity == nullptr)
      return;
    materials_ = &elasticity->materials;
    stiffness_ = stiffnesses(*elasticity);
    strain_ = std::make_unique<StrainOperator>(mesh, cell, isProjected(mesh, *elasticity));
  }

  // For the cell that the integrator has turned to.
  void turnTo(int c) {
    members_ = mesh_.cell(c);
    if (materials_ == nullptr)
      return;
    strain_->update();
    material_ = &stiffnessOf(stiffness_, mesh_.region(c));
    expansion_ = (*materials_)[static_cast<std::size_t>(mesh_.region(c))].thermalStrain();
  }

  // For one of the solutions on the mesh.
  void setSolution(const NodalSolution& solution) {
    const std::size_t components = materials_ == nullptr ? 1 : static_cast<std::size_t>(mesh_.dimension());
    values_.clear();
    for (int i = 0; i < cell_.basisSize(); ++i)
      for (std::size_t d = 0; d < components; ++d)
        values_.push_back((*solution.values)[static_cast<std::size_t>(members_[i]) * components + d]);
    for (std::size_t r = 0; r < 6; ++r)
      thermal_[r] = solution.temperature * expansion_[r];
  }

  // Entries that are not zero always: two of a membrane.
  std::size_t entries() const { return materials_ == nullptr ? 2 : 6; }

  Voigt at(int q) const {
    if (materials_ != nullptr)
      return strain_->stress(q, values_.data(), *material_, thermal_);
    Voigt flux{};
    for (int i = 0; i < cell_.basisSize(); ++i)
      for (std::size_t d = 0; d < 2; ++d)
        flux[d] += cell_.gradient(i, q)[d] * values_[static_cast<std::size_t>(i)];
    return flux;
  }

 private:
  const Mesh& mesh_;
  const CellIntegrator& cell_;
  const std::vector<Material>* materials_ = nullptr;
  std::vector<VoigtMatrix> stiffness_;
  std::unique_ptr<StrainOperator> strain_;
  std::vector<double> values_;
  const int* members_ = nullptr;
  const VoigtMatrix* material_ = nullptr;
  Voigt expansion_{}, thermal_{};
};

std::vector<StressSums> sumsOf(const Mesh& mesh, const Elasticity* elasticity,
                               const std::vector<NodalSolution>& solutions) {
  const CellShape& shape = shapeOf(mesh.cellType);
  const bool projected = elasticity != nullptr && isProjected(mesh, *elasticity);
  // Stresses are sampled at fewer points than stiffness has; with a projected dilatation, which needs those,
  // where they are integrated.
  const int sampleDegree = shape.order == 1 ? 1 : (shape.isSimplex ? 2 : 3);
  const ReferenceElement element(mesh.cellType, projected && shape.order == 2 ? stiffnessDegree(mesh.cellType)
                                                                              : sampleDegree);
  CellIntegrator cell(mesh, element);
  CellStress stress(mesh, cell, elasticity);
  const auto nodes = static_cast<std::size_t>(mesh.numberOfNodes());
  const std::size_t entries = stress.entries();
  const int m = polynomials(shape.order - 1, mesh.dimension());
  const auto functions = static_cast<std::size_t>(m), points = static_cast<std::size_t>(cell.points()),
             size = static_cast<std::size_t>(cell.basisSize());
  std::vector<StressSums> all(solutions.size(), {std::vector<Voigt>(nodes), std::vector<double>(nodes, 0.0),
                                                 std::vector<std::array<int, 2>>(nodes, {INT_MAX, INT_MIN})});
  std::vector<double> gram, toNodes(size * points);
  std::vector<Voigt> values(points);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const int* members = mesh.cell(c);
    const int region = mesh.region(c);
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
      gram.assign(functions * functions, 0.0);
      std::vector<double> moments(functions * points);
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
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      for (std::size_t q = 0; q < points; ++q)
        values[q] = stress.at(static_cast<int>(q));
      StressSums& sums = all[k];
      for (std::size_t i = 0; i < size; ++i) {
        const auto node = static_cast<std::size_t>(members[i]);
        sums.size[node] += area;
        sums.regions[node] = {std::min(sums.regions[node][0], region),
                              std::max(sums.regions[node][1], region)};
        for (std::size_t q = 0; q < points; ++q)
          for (std::size_t r = 0; r < entries; ++r)
            sums.weighted[node][r] += toNodes[i * points + q] * values[q][r];
      }
    }
  }
  return all;
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

RecoveryError errorOf(const Mesh& mesh, const Elasticity* elasticity,
                      const std::vector<NodalSolution>& solutions,
                      const std::vector<const StressSums*>& recovered) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType));
  CellIntegrator cell(mesh, element);
  CellStress stress(mesh, cell, elasticity);
  const std::vector<VoigtMatrix> compliance =
      elasticity != nullptr ? compliances(*elasticity) : std::vector<VoigtMatrix>{};
  RecoveryError result;
  const std::size_t entries = stress.entries();
  const auto size = static_cast<std::size_t>(cell.basisSize());
  std::vector<Voigt> nodal(size);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const int* members = mesh.cell(c);
    const VoigtMatrix* inverse = elasticity != nullptr ? &stiffnessOf(compliance, mesh.region(c)) : nullptr;
    const auto product = [&](const Voigt& s) {
      if (inverse == nullptr)
        return s[0] * s[0] + s[1] * s[1];
      double sum = 0.0;
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t k = 0; k < 6; ++k)
          sum += s[r] * (*inverse)[r][k] * s[k];
      return sum;
    };
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      bool counts = true;
      for (std::size_t i = 0; i < size; ++i) {
        const auto node = static_cast<std::size_t>(members[i]);
        counts = counts && recovered[k]->regions[node][0] == recovered[k]->regions[node][1];
        nodal[i] = recovered[k]->weighted[node];
      }
      for (int q = 0; q < cell.points(); ++q) {
        Voigt difference = stress.at(q);
        result.energy += cell.measure(q) * product(difference);
        if (!counts)
          continue;
        for (std::size_t i = 0; i < size; ++i)
          for (std::size_t r = 0; r < entries; ++r)
            difference[r] -= cell.value(static_cast<int>(i), q) * nodal[i][r];
        result.error += cell.measure(q) * product(difference);
      }
    }
  }
  return result;
}

} // namespace

std::vector<StressSums> stressSums(const Mesh& mesh, const Elasticity& elasticity,
                                   const std::vector<NodalSolution>& solutions) {
  return sumsOf(mesh, &elasticity, solutions);
}

std::vector<StressSums> fluxSums(const Mesh& mesh, const std::vector<NodalSolution>& solutions) {
  return sumsOf(mesh, nullptr, solutions);
}

RecoveryError recoveryError(const Mesh& mesh, const Elasticity& elasticity,
                            const std::vector<NodalSolution>& solutions,
                            const std::vector<const StressSums*>& recovered) {
  return errorOf(mesh, &elasticity, solutions, recovered);
}

RecoveryError fluxRecoveryError(const Mesh& mesh, const std::vector<NodalSolution>& solutions,
                                const std::vector<const StressSums*>& recovered) {
  return errorOf(mesh, nullptr, solutions, recovered);
}

} // namespace Harmos::fem
