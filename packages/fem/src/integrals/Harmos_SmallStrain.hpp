// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StrainOperator.hpp"

#include <vector>

namespace Harmos::fem {

/// Strains of small displacements at the points of one cell after another, as FiniteStrain has those of
/// others.
class SmallStrain {
 public:
  SmallStrain(const Mesh& mesh, const CellIntegrator& cell, bool projected)
      : operator_(mesh, cell, projected), strains_(static_cast<std::size_t>(cell.points())) {}

  std::size_t rows() const { return operator_.rows(); }
  std::size_t dofs() const { return operator_.dofs(); }
  double leastJacobian() const { return 1.0; }
  const Voigt& strain(int q) const { return strains_[static_cast<std::size_t>(q)]; }
  /// Row r of B̄ at point q.
  const double* row(int q, std::size_t r) const { return operator_.row(q, r); }

  /// For the cell that the integrator has turned to. @param values its displacements, node by node.
  void update(const double* values, bool /*needsOperator*/ = true) {
    operator_.update();
    for (std::size_t q = 0; q < strains_.size(); ++q) {
      strains_[q] = {};
      for (std::size_t r = 0; r < rows(); ++r)
        for (std::size_t j = 0; j < dofs(); ++j)
          strains_[q][r] += row(static_cast<int>(q), r)[j] * values[j];
    }
  }

 private:
  StrainOperator operator_;
  std::vector<Voigt> strains_;
};

} // namespace Harmos::fem
