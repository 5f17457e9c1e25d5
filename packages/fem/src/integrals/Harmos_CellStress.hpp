// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LawStress.hpp"
#include "Harmos_StrainOperator.hpp"
#include "Harmos_StressSums.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace Harmos::fem {

/// Of stresses: six of an elastic mesh, two of a membrane, whose other entries are zero. Known to the
/// compiler, since loops over them are the innermost ones.
template<std::size_t Entries>
using Stress = std::array<double, Entries>;

constexpr std::size_t elasticEntries = 6, membraneEntries = 2;

/// Stresses of an elastic mesh, or the gradient of a membrane, cell after cell.
template<std::size_t Entries>
class CellStress {
 public:
  CellStress(const Mesh& mesh, const ReferenceElement& element, const CellIntegrator& cell,
             const Elasticity* elasticity)
      : mesh_(mesh),
        element_(element),
        cell_(cell),
        components_(Entries == membraneEntries ? 1 : static_cast<std::size_t>(mesh.dimension())),
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
    if constexpr (Entries == elasticEntries) {
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

/// Of the rule whose points stresses are sampled at: one order lower than that of stiffness. With a projected
/// dilatation, which needs those, where they are integrated; states are there, too.
inline int samplingDegree(const Mesh& mesh, const Elasticity* elasticity) {
  const int order = shapeOf(mesh.cellType).order;
  const bool hasStates = elasticity != nullptr && MaterialLaws(*elasticity).stateSize() > 0;
  const bool isBound = elasticity != nullptr && isProjected(mesh, *elasticity) && order == 2;
  if (hasStates || isBound)
    return stiffnessDegree(mesh, elasticity->integration);
  return order == 1 ? 1 : (shapeOf(mesh.cellType).isSimplex ? 2 : 3);
}

} // namespace Harmos::fem
