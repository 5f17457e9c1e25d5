// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseSpace.hpp"
#include "Harmos_Deflation.hpp"
#include "Harmos_DualOptions.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PreconditionerKind.hpp"

#include <memory>
#include <optional>
#include <string>

namespace Harmos::feti {

class DualOperator;
class DualPreconditioner;

/// Coarse vectors for what a weighted projector cannot cure: materials that jump within subdomains, ragged
/// and slender parts, near-incompressibility.
///
/// In each subdomain s the modes v of
///
///     N_s v = μ S_s v,   N_s = B_sᵀMB_s
///
/// with μ above the threshold, which cost the subdomain little, but much as a jump: for these PMF has
/// eigenvalues far above the others, as bounded by the threshold and the number of neighbours (Spillane,
/// Rixen, Automatic spectral coarse spaces for robust FETI and BDD algorithms, Int. J. Numer. Meth. Engng.
/// 95, 2013, FETI-GenEO). Those with μ = ∞ are the rigid motions, which G takes care of. U = PMB_sv spans
/// what Deflation eliminates.
///
/// With inequalities U is made of rows of equality alone, P, M and N too: there are no entries where there
/// are bounds, GU = 0, and the elimination is exact. What of the bad modes goes through closed contacts
/// stays with the solver: which of them are closed is not known before.
///
/// They are made in the condensed form, where products with many vectors are dense ones: from inverses made
/// for them alone where the products of the solver are in the implicit form. PFP does not depend on that.
///
/// Guarded by tests/unit/feti/test_adaptive_space.cpp and tests/verification/test_inclusions.py.
class AdaptiveSpace {
 public:
  /// What vectors are made from. All to outlive what is made with it.
  struct Stages {
    const SubdomainSystem& system;
    const Constraints& constraints;
    const LocalInverses& inverses;
    const CoarseSpace& coarse;
    const DualOperator& dual;
    Teuchos::RCP<const DualPreconditioner> preconditioner; ///< null: there are no vectors
  };
  /// How these were made.
  struct Forms {
    LocalInverseOptions inverses;
    PreconditionerKind preconditioner = PreconditionerKind::Dirichlet;
    PreconditionerScaling scaling = PreconditionerScaling::Multiplicity;
  };

  AdaptiveSpace(Stages stages, Forms forms, const AdaptiveOptions& options);

  const AdaptiveOptions& options() const { return options_; }
  /// Whether vectors may be made, or were made.
  bool isPossible() const {
    return options_.vectors != AdaptiveVectors::None && !stages_.preconditioner.is_null();
  }
  bool isMade() const { return isMade_; }
  /// Makes them and tells the log their number and their seconds, or why there are none: there may be no such
  /// mode, or not the memory. @throws NumericalError, InternalError on all ranks. @note Collective.
  void make(const Log& log);
  /// Null: not made, or there are none.
  const Deflation* deflation() const { return deflation_ ? &*deflation_ : nullptr; }
  double seconds() const { return seconds_; }
  const DualOperator& dualOperator() const { return stages_.dual; }

 private:
  std::string makeVectors();

  Stages stages_;
  Forms forms_;
  AdaptiveOptions options_;
  bool isMade_ = false;
  double seconds_ = 0.0;
  std::optional<Deflation> deflation_;
};

} // namespace Harmos::feti
