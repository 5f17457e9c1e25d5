// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverses.hpp"
#include "Harmos_PreconditionerKind.hpp"

#include <optional>
#include <string>
#include <vector>

namespace Harmos::feti {

/// How products with F and with its preconditioner are made.
struct DualForms {
  DualForm form = DualForm::Condensed;
  PreconditionerKind preconditioner = PreconditionerKind::Dirichlet;
};

/// What products are expected to cost on the busiest rank.
struct FormPrediction {
  double setupSeconds = 0.0;
  double productSeconds = 0.0;   ///< of F, and of the preconditioner with it
  double relativeProducts = 1.0; ///< how many it takes, over those with the Dirichlet preconditioner
  double bytes = 0.0;            ///< of factors and dense blocks
  double factorBytes = 0.0;      ///< of sparse factors alone
  double seconds(double products) const {
    return setupSeconds + products * relativeProducts * productSeconds;
  }

  /// Of another class on the same rank.
  FormPrediction& operator+=(const FormPrediction& other);
};

/// What factorisations are expected to need, of their analyses.
struct FactorizationEstimate {
  int rows = 0;                                      ///< n
  int boundary = 0;                                  ///< n_b
  double entries = 0.0, flops = 0.0;                 ///< of L of K, as far as boundary loads reach
  double interiorEntries = 0.0, interiorFlops = 0.0; ///< of L of K_ii
  double schurFlops = 0.0;                           ///< of that with S
  double blockEntries = 0.0, couplingEntries = 0.0;  ///< of K_bb, of K_bi

  /// Of a subdomain of another size: in proportion. Factors grow somewhat more than that.
  FactorizationEstimate scaledTo(int otherRows, int otherBoundary) const;
};

/// What analyses of K and of K_ii say; nothing is factored. @param boundary rising. @param context keeps the
/// analyses. @throws InternalError. Local.
FactorizationEstimate analyseFactorization(const LocalMatrix& matrix, const std::vector<int>& boundary,
                                           FactorizationContext& context);

/// Rates of a machine. The defaults are those of one core with two in use and OpenBLAS, measured on meshes of
/// real bodies and on the model problem; only their ratios decide. The same in every run: what is chosen is
/// so as well.
struct MachineRates {
  double sparseFlops = 9e9;    ///< of a sparse factorisation
  double schurFlops = 1.3e10;  ///< of one with a Schur complement
  double denseFlops = 2.7e10;  ///< of matrix-matrix products and dense factorisations
  double setupEntries = 1.8e8; ///< factor entries a second in assembly, storing and verification
  double setupRows = 4.6e5;    ///< rows a second in ordering and analysis
  double solveBytes = 1.3e10;  ///< at which a solution reads its factor
  double sparseBytes = 8e9;    ///< at which a product with a sparse matrix reads it
  double streamBytes = 1.8e10; ///< at which a packed dense matrix is read
};

/// Costs of one class of m congruent subdomains, e entries and c flops of the factorisation of K (index i: of
/// K_ii, S: with S), n_b boundary dofs, k_bb and k_bi entries of blocks of K; w bytes a number of dense
/// blocks or of L:
///
///     implicit    set-up   c/sparse + σ(n, e)
///                 product  m·2·w·e/solve, twice that with refinement; w = 4 where products are rounded
///       Dirichlet set-up   + c_i/sparse + σ(n_i, e_i)
///                 product  + m(16·e_i/solve + 12(k_bb + 2k_bi)/sparse)
///     condensed   set-up   c_S/schur + σ(n_i, e_i) + n_b³/dense
///                 product  m·2n_b²/dense; for m < 3, packed, m·w·n_b²/2/stream
///       Dirichlet product  another such block
///     lumped      product  + m·12·k_bb/sparse
///
/// with σ(n, e) = n/setupRows + e/setupEntries. With the lumped preconditioner the number of products is 1 +
/// 0.35 log₂(n/n_b) times as large, within 1 and 2.75: between 1.0 and 1.3 was measured on real bodies, 1.4
/// to 2.8 on the model problem of 8 to 128 elements.
/// @param isRounded LocalInverseOptions::expectsRoundedProducts().
FormPrediction predict(const DualForms& forms, const FactorizationEstimate& estimate, int members,
                       Precision precision, const MachineRates& rates = {}, bool isRounded = false);

/// What may be chosen.
struct FormLimits {
  std::optional<DualForm> form;                     ///< the only one, if there is one
  std::optional<PreconditionerKind> preconditioner; ///< the same
  /// Whether the lumped preconditioner may be chosen: not where materials jump, whose spectra it leaves wide.
  bool mayLump = true;
  int products = 30;      ///< expected with the Dirichlet preconditioner
  double budgetMiB = 0.0; ///< of each rank, by the deck; 0 for none
  double memoryMiB = 0.0; ///< of the machine for each rank; 0 for none. Beyond, what needs least is chosen
  /// Of the run that this one goes on with: kept if it is allowed and fits into the memory.
  std::optional<DualForms> before;

  bool allows(const DualForms& forms) const;
};

/// The ways there are, in the order in which near-ties are decided.
const std::vector<DualForms>& dualForms();

/// The place in dualForms() of what is to be taken, of predictions in that order: the first one that is
/// allowed, fits into the memory, and takes at most 10 per cent more time than the fastest such, unless
/// there is one from before. None if nothing that is allowed fits into the budget.
std::optional<std::size_t> bestOf(const std::vector<FormPrediction>& predictions, const FormLimits& limits);

/// The decision, the same on all ranks.
struct FormChoice {
  DualForms forms;
  std::vector<FormPrediction> predictions; ///< maxima over the ranks, in the order of dualForms()
  std::string reason;                      ///< a sentence for the log

  const FormPrediction& of(const DualForms& forms) const;
};

/// The way with the least time that fits into the memory.
///
/// Each rank analyses its largest class and scales that for the others; where already a factor as sparse as K
/// itself would make the implicit form slower, nothing more is asked. The context keeps the analyses.
/// @throws InputError on all ranks if nothing that is allowed fits into the budget, telling what would be
/// needed.
/// @note Collective.
FormChoice chooseForm(const SubdomainSystem& system, const Constraints& constraints,
                      const LocalInverseOptions& options, const FormLimits& limits,
                      FactorizationContext& context, const MachineRates& rates = {});

/// Memory of this machine for each of its ranks, in MiB. @note Collective.
double machineMemoryMiB(const Teuchos::Comm<int>& comm);

const char* toString(DualForm form);
const char* toString(PreconditionerKind kind);
/// "implicit lumped".
std::string toString(const DualForms& forms);
/// None for another text. The inverse of toString().
std::optional<DualForms> dualFormsFrom(const std::string& text);

} // namespace Harmos::feti
