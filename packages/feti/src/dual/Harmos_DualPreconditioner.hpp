// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverses.hpp"
#include "Harmos_PreconditionerKind.hpp"
#include "Harmos_SubdomainSum.hpp"

#include <memory>

namespace Harmos::feti {

/// The dual preconditioner M⁻¹ = B_D S B_Dᵀ, B_D = (BD⁻¹Bᵀ)⁻¹BD⁻¹ (Klawonn, Widlund: FETI and Neumann–Neumann
/// iterative substructuring methods, Comm. Pure Appl. Math. 54, 2001, in the form for rows that are not
/// redundant).
///
/// BD⁻¹Bᵀ couples rows that share a copy of a dof: small groups (the rows at a cross point), each inverted
/// densely. Groups of more than `mostRows` rows (mortar conditions along a surface) are inverted by their
/// diagonal, and so is a row that depends on others of its group: M is to see what F does not. With
/// orthonormal rows and Scaling::Multiplicity, B_D = B. Cost of a product: as of F in the condensed form.
///
/// Of rows that give way, (F + C)⁻¹ is approximated by TM⁻¹T + (I − T²)²C⁻¹, T² = q/(q + C), q the diagonal
/// of BD⁻¹Bᵀ: the first part alone where C is small, the second where it is large.
///
/// Where subdomains are joined to clusters, M⁻¹ = B_D(S − SC(CᵀSC)⁻CᵀS)B_Dᵀ, C the motions of faces within a
/// cluster, the same on both sides: as BC = 0, and averages of C agree, that is the least energy of all
/// extensions B_Dᵀx + Cy, and no eigenvalue of M⁻¹F falls below one by it, as without C (Klawonn, Widlund,
/// Dryja: Dual-primal FETI methods for three-dimensional elliptic problems with heterogeneous coefficients,
/// SIAM J. Numer. Anal. 40, 2002).
/// Directions keep to what F sees: UᵀM⁻¹x = 0 (Clusters).
///
/// To be used between projections: PM⁻¹P.
/// Guarded by tests/unit/feti/test_dual_preconditioner.cpp.
class DualPreconditioner : public SubdomainSum {
 public:
  static constexpr int mostRows = 64;

  /// @param kind not None.
  /// @throws NumericalError on all ranks. @note Collective.
  DualPreconditioner(const SubdomainSystem& system, const Constraints& constraints,
                     const LocalInverses& inverses, PreconditionerKind kind, PreconditionerScaling scaling);

  PreconditionerKind kind() const { return kind_; }

  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

 private:
  PreconditionerKind kind_;
  std::shared_ptr<const Clusters> clusters_; ///< or null
  std::vector<double> ofRows_;               ///< (I − T²)²C⁻¹; none where no row gives way
};

/// The entries of B_D, of TB_D where rows give way, by subdomains, over an overlapping map of their own.
struct ScaledConstraints {
  Teuchos::RCP<const Import> importer;
  std::vector<std::vector<Constraints::Entry>> entries; ///< of each subdomain of this rank
};

/// @note Collective.
ScaledConstraints scaledConstraints(const SubdomainSystem& system, const Constraints& constraints,
                                    PreconditionerScaling scaling);

} // namespace Harmos::feti
