// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressSums.hpp"

#include "Harmos_LawStress.hpp"
#include "Harmos_StrainOperator.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <memory>
#include <optional>

namespace Harmos::fem {
namespace {

// Functions of a coordinate relative to a point of the cell: 1, or 1, x, y(, z).
int polynomials(int degree, int dimension) {
  return degree == 0 ? 1 : 1 + dimension;
}

// Of stresses: six of an elastic mesh, two of a membrane, whose other entries are zero. Known to the
// compiler, since loops over them are the innermost ones.
template<std::size_t Entries>
using Stress = std::array<double, Entries>;

constexpr std::size_t elastic = 6, membrane = 2;

// Stresses of an elastic mesh, or the gradient of a membrane, cell after cell.
template<std::size_t Entries>
class CellStress {
 public:
  CellStress(const Mesh& mesh, const ReferenceElement& element, const CellIntegrator& cell,
             const Elasticity* elasticity)
      : mesh_(mesh),
        element_(element),
        cell_(cell),
        components_(Entries == membrane ? 1 : static_cast<std::size_t>(mesh.dimension())),
        values_(static_cast<std::size_t>(cell.basisSize()) * components_) {
    if (elasticity == nullptr)
      return;
    elasticity_ = elasticity;
    if (LawStress::isOf(*elasticity)) {
      byLaw_ = std::make_unique<LawStress>(mesh, cell, *elasticity);
      return;
    }
    stiffness_ = stiffnesses(*elasticity);
    strain_ = std::make_unique<StrainOperator>(mesh, cell, isProjected(mesh, *elasticity));
  }

  // For the cell that the integrator has turned to.
  void turnTo(int c) {
    members_ = mesh_.cell(c);
    number_ = c;
    if (byLaw_ != nullptr)
      byLaw_->turnTo(mesh_, c);
    if (strain_ == nullptr)
      return;
    strain_->update();
    material_ = &stiffnessOf(stiffness_, mesh_.region(c));
    thermal_.expansion = elasticity_->materials[static_cast<std::size_t>(mesh_.region(c))].thermalStrain();
  }

  // For one of the solutions on the mesh.
  void setSolution(const NodalSolution& solution) {
    const double* all = solution.values->data();
    double* next = values_.data();
    for (int i = 0; i < cell_.basisSize(); ++i)
      for (std::size_t d = 0; d < components_; ++d)
        *next++ = all[static_cast<std::size_t>(members_[i]) * components_ + d];
    thermal_.rise = solution.temperature;
    for (std::size_t r = 0; r < 6; ++r)
      thermal_.strain[r] = solution.temperature * thermal_.expansion[r];
    thermal_.nodal = solution.temperatures.get();
    if (thermal_.nodal != nullptr && !field_)
      field_.emplace(mesh_, element_, elasticity_->integration);
    if (byLaw_ != nullptr)
      byLaw_->update(values_.data(), solution.states);
  }

  // See MaterialLaw::shownState().
  double shownAt(int q) const { return byLaw_ != nullptr ? byLaw_->shownAt(q) : 0.0; }

  Stress<Entries> at(int q) const {
    if constexpr (Entries == elastic) {
      if (byLaw_ != nullptr)
        return byLaw_->at(q, thermal_.rise +
                                 (thermal_.nodal != nullptr ? field_->at(*thermal_.nodal, number_, q) : 0.0));
      if (thermal_.nodal == nullptr)
        return strain_->stress(q, values_.data(), *material_, thermal_.strain);
      Voigt thermal = thermal_.strain;
      for (std::size_t r = 0; r < 6; ++r)
        thermal[r] += field_->at(*thermal_.nodal, number_, q) * thermal_.expansion[r];
      return strain_->stress(q, values_.data(), *material_, thermal);
    } else {
      Stress<Entries> flux{};
      for (int i = 0; i < cell_.basisSize(); ++i) {
        const Point& gradient = cell_.gradient(i, q);
        for (std::size_t d = 0; d < Entries; ++d)
          flux[d] += gradient[d] * values_[static_cast<std::size_t>(i)];
      }
      return flux;
    }
  }

 private:
  const Mesh& mesh_;
  const ReferenceElement& element_;
  const CellIntegrator& cell_;
  std::size_t components_;
  int number_ = 0;
  std::optional<TemperatureField> field_; // where there are any
  const Elasticity* elasticity_ = nullptr;
  std::vector<VoigtMatrix> stiffness_;
  std::unique_ptr<StrainOperator> strain_; // of stiffness, or
  std::unique_ptr<LawStress> byLaw_;
  std::vector<double> values_;
  const int* members_ = nullptr;
  const VoigtMatrix* material_ = nullptr;
  // Strains of a degree, and of the body's rise; rises at nodes besides.
  struct Thermal {
    double rise = 0.0;
    Voigt expansion{}, strain{};
    const std::vector<double>* nodal = nullptr;
  } thermal_;
};

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
  const bool projected = elasticity != nullptr && isProjected(mesh, *elasticity);
  // Stresses are sampled at fewer points than stiffness has; with a projected dilatation, which needs those,
  // where they are integrated. States are there, too.
  const bool hasStates = elasticity != nullptr && MaterialLaws(*elasticity).stateSize() > 0;
  const int degree = hasStates || (projected && shape.order == 2)
                         ? stiffnessDegree(mesh, elasticity->integration)
                         : (shape.order == 1 ? 1 : (shape.isSimplex ? 2 : 3));
  const ReferenceElement element(mesh.cellType, degree);
  CellIntegrator cell(mesh, element);
  CellStress<Entries> stress(mesh, element, cell, elasticity);
  const auto nodes = static_cast<std::size_t>(mesh.numberOfNodes());
  const int m = polynomials(shape.order - 1, mesh.dimension());
  const auto points = static_cast<std::size_t>(cell.points()),
             size = static_cast<std::size_t>(cell.basisSize());
  std::vector<StressSums> all(solutions.size(), {std::vector<Voigt>(nodes), std::vector<double>(nodes, 0.0),
                                                 std::vector<std::array<int, 2>>(nodes, {INT_MAX, INT_MIN}),
                                                 std::vector<double>(hasStates ? nodes : 0, 0.0)});
  std::vector<double> toNodes(size * points);
  std::vector<Stress<Entries>> values(points);
  std::vector<double> shown(points);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    stress.turnTo(c);
    const int* members = mesh.cell(c);
    const int region = mesh.region(c);
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
        std::array<int, 2>& regions = sums.regions[node];
        regions = {std::min(regions[0], region), std::max(regions[1], region)};
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

template<std::size_t Entries>
RecoveryError errorOf(const Mesh& mesh, const Elasticity* elasticity,
                      const std::vector<NodalSolution>& solutions,
                      const std::vector<const StressSums*>& recovered) {
  const ReferenceElement element(
      mesh.cellType,
      stiffnessDegree(mesh, elasticity != nullptr ? elasticity->integration : Integration::Full));
  CellIntegrator cell(mesh, element);
  CellStress<Entries> stress(mesh, element, cell, elasticity);
  const std::vector<VoigtMatrix> compliance =
      elasticity != nullptr ? compliances(*elasticity) : std::vector<VoigtMatrix>{};
  RecoveryError result;
  result.cells.assign(solutions.size(),
                      std::vector<double>(static_cast<std::size_t>(mesh.numberOfCells()), -1.0));
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
    const int* members = mesh.cell(c);
    const VoigtMatrix* inverse = elasticity != nullptr ? &stiffnessOf(compliance, mesh.region(c)) : nullptr;
    const auto product = [&](const Stress<Entries>& s) {
      double sum = 0.0;
      for (std::size_t r = 0; r < Entries; ++r)
        if constexpr (Entries == membrane)
          sum += s[r] * s[r];
        else
          for (std::size_t k = 0; k < Entries; ++k)
            sum += s[r] * (*inverse)[r][k] * s[k];
      return sum;
    };
    for (std::size_t k = 0; k < solutions.size(); ++k) {
      stress.setSolution(solutions[k]);
      bool counts = true;
      for (std::size_t i = 0; i < size; ++i) {
        const auto node = static_cast<std::size_t>(members[i]);
        const std::array<int, 2>& regions = recovered[k]->regions[node];
        counts = counts && regions[0] == regions[1];
        std::copy_n(recovered[k]->weighted[node].begin(), Entries, nodal[i].begin());
      }
      double error = counts ? 0.0 : -1.0;
      for (std::size_t q = 0; q < points; ++q) {
        const double measure = cell.measure(static_cast<int>(q));
        Stress<Entries> difference = stress.at(static_cast<int>(q));
        result.energy += measure * product(difference);
        for (std::size_t i = 0; i < size && counts; ++i)
          for (std::size_t r = 0; r < Entries; ++r)
            difference[r] -= basis[q * size + i] * nodal[i][r];
        const double part = counts ? measure * product(difference) : 0.0;
        result.error += part;
        error += part;
      }
      result.cells[k][static_cast<std::size_t>(c)] = error;
    }
  }
  return result;
}

} // namespace

std::vector<StressSums> stressSums(const Mesh& mesh, const Elasticity& elasticity,
                                   const std::vector<NodalSolution>& solutions) {
  return sumsOf<elastic>(mesh, &elasticity, solutions);
}

std::vector<std::vector<Voigt>> cellStresses(const Mesh& mesh, const Elasticity& elasticity,
                                             const std::vector<NodalSolution>& solutions) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh, elasticity.integration));
  CellIntegrator cell(mesh, element);
  CellStress<elastic> stress(mesh, element, cell, &elasticity);
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
  return sumsOf<membrane>(mesh, nullptr, solutions);
}

RecoveryError recoveryError(const Mesh& mesh, const Elasticity& elasticity,
                            const std::vector<NodalSolution>& solutions,
                            const std::vector<const StressSums*>& recovered) {
  return errorOf<elastic>(mesh, &elasticity, solutions, recovered);
}

RecoveryError fluxRecoveryError(const Mesh& mesh, const std::vector<NodalSolution>& solutions,
                                const std::vector<const StressSums*>& recovered) {
  return errorOf<membrane>(mesh, nullptr, solutions, recovered);
}

} // namespace Harmos::fem
