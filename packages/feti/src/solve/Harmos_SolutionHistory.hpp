// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualSolution.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <deque>
#include <optional>
#include <string>

namespace Harmos::feti {

/// For checkpoints, under names that begin so. @param problem any of those with the same K and B. @note
/// Collective.
void exchange(qp::StateArchive<MultiVector>& archive, const DualProblem& problem, const std::string& name,
              WarmStart& start);

/// Solutions of problems with one K and B and many loads and bounds, all with the same contacts open, and
/// where to start the next one.
///
/// As long as the same contacts are open, λ and μ are linear in the data (d, λ̃): the data of the next problem
/// are fitted by those of the last ones, and their solutions are combined with the same coefficients. The fit
/// is regularised by the tolerance of the solutions, whose errors large coefficients would multiply. No
/// product with F. Guarded by tests/unit/feti/test_feti_solver.cpp.
class SolutionHistory {
 public:
  static constexpr std::size_t most = 8;

  /// Takes the solution of a problem; forgets those with other open contacts.
  /// @param multiplier λ + λ̃, exactly zero where a contact is open. @note Collective.
  void add(const DualProblem& problem, const Teuchos::RCP<const MultiVector>& multiplier,
           const std::vector<double>& mu);
  /// Nothing without a solution. @param tolerance of the solutions. @note Collective.
  std::optional<WarmStart> start(const DualProblem& problem, double tolerance) const;
  void clear() { entries_.clear(); }
  /// For checkpoints. @param problem any of those with this K and B. @param prefix of names there, where an
  /// archive has several histories. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const DualProblem& problem,
                const std::string& prefix = "");

 private:
  struct Entry {
    Teuchos::RCP<const MultiVector> d, shift, multiplier;
    std::vector<double> mu; // empty without equality rows
  };
  std::deque<Entry> entries_;
};

} // namespace Harmos::feti
