// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverses.hpp"

#include <string>

namespace Harmos::feti {

/// What a form is expected to cost on the busiest rank.
struct FormPrediction {
  double setupSeconds = 0.0;
  double productSeconds = 0.0; ///< of F, and of the preconditioner with it
  double bytes = 0.0;          ///< of factors and dense blocks
  double seconds(double products) const { return setupSeconds + products * productSeconds; }
};

/// What a factorisation is expected to need, of MUMPS' analysis.
struct FactorizationEstimate {
  int rows = 0;         ///< n
  int boundary = 0;     ///< n_b
  double entries = 0.0; ///< of the factors of K_ii
  double flops = 0.0;   ///< of the factorisation with the Schur complement
};

/// What MUMPS' analysis of K, with the boundary for Schur rows, expects; nothing is factored.
/// @param boundary rising. @throws NumericalError, InternalError. Local.
FactorizationEstimate analyseFactorization(const LocalMatrix& matrix, const std::vector<int>& boundary);

/// Rates of a machine. The defaults are those of one core of an AMD EPYC with two cores in use and OpenBLAS,
/// fitted to what tests/performance/dual_operator measures; only their ratios decide.
struct MachineRates {
  double sparseFlops = 7e9;     ///< of a sparse factorisation
  double denseFlops = 3e10;     ///< of matrix-matrix products and dense factorisations
  double setupEntries = 2e7;    ///< factor entries a second in analysis, assembly and verification
  double orderingEntries = 1e7; ///< factor entries a second in METIS, which the condensed form does without
  double solveFlops = 2.7e9;    ///< of sparse solves with many right-hand sides
  double solveBytes = 2.2e9;    ///< at which a sparse solve reads its factors
  double streamBytes = 1.8e10;  ///< at which a packed dense matrix is read
};

/// Costs of one class of m congruent subdomains, e entries and c flops of the factorisation, n_b boundary
/// dofs:
///
///     implicit    set-up   c/sparse + e/setup + e/ordering
///                 product  ⌈m/32⌉·2·8e/solveBytes + m·4e/solveFlops
///                 bytes    12e
///     condensed   set-up   c/sparse + e/setup + n_b³/dense
///                 product  m·2n_b²/dense; for m < 3, packed, m·4n_b²/stream
///                 bytes    12e + 16n_b²; packed 12e + 12n_b²
///
/// A Dirichlet preconditioner doubles the product; the implicit form's set-up and memory too, the condensed
/// one's by another dense block.
FormPrediction predict(DualForm form, const FactorizationEstimate& estimate, int members,
                       const LocalInverseOptions& options, const MachineRates& rates = {});

/// The decision, the same on all ranks.
struct FormChoice {
  DualForm form = DualForm::Condensed;
  FormPrediction implicit, condensed; ///< maxima over the ranks
  std::string reason;                 ///< a sentence for the log
};

/// The form with less time for the expected number of products that fits into the memory budget.
///
/// Where already factors as sparse as K itself would make the implicit form slower, nothing more is asked.
/// Otherwise each rank asks MUMPS for an analysis of its largest class and scales it by n for the others.
/// @param budgetMiB of each rank; 0 for none. @param wanted the form to be judged, or null for either.
/// @throws InputError on all ranks if nothing that is allowed fits, telling what would be needed.
/// @note Collective.
FormChoice chooseForm(const SubdomainSystem& system, const Constraints& constraints,
                      const LocalInverseOptions& options, const DualForm* wanted, int expectedProducts,
                      double budgetMiB);

const char* toString(DualForm form);

} // namespace Harmos::feti
