// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_Kernel.hpp"
#include "Harmos_LocalFactorization.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// A generalised inverse K⁺ of one subdomain matrix, K K⁺ K = K, and its restriction to the boundary dofs b.
class LocalInverse {
 public:
  virtual ~LocalInverse() = default;

  /// X ← K⁺X for count vectors, column after column. @throws NumericalError, InternalError. Local.
  virtual void apply(double* x, int count) const = 0;

  /// (K⁺)_bb.
  virtual const BoundaryOperator& boundaryOperator() const = 0;

  /// S = K_bb − K_bi K_ii⁻¹ K_ib; made at the first call where the form does not have it anyway.
  /// @throws NumericalError, InternalError.
  virtual std::shared_ptr<const BoundaryOperator> schurComplement() const = 0;

  /// S may be in single precision: a preconditioner does not enter the answer, and 6e-8 κ of the spectrum of
  /// what it preconditions is little where the matrix is well conditioned. To be called before
  /// schurComplement(), and again after refactor().
  virtual void roundSchurComplement() = 0;

  /// Products on the boundary may be made with factors in single precision, if that changes the answer to a
  /// load by at most so much in the energy norm, relatively, which is tried; apply() is refined then. Where
  /// it cannot be, nothing changes. To be called again after refactor().
  virtual void roundProducts(double /*most*/) {}
  /// Whether they are.
  virtual bool hasRoundedProducts() const { return false; }
  /// They are made in double precision again: another factorisation of the matrix that is there, where they
  /// were rounded. Boundary operators that were handed out stay valid. @throws as refactor().
  virtual void restoreProducts() {}

  /// Memory held by factors and dense blocks.
  virtual double bytes() const = 0;

  /// Becomes the inverse of another matrix with the same graph, and a kernel of the same dimension, by the
  /// analysis that is there. Boundary operators that were handed out before are not to be used again.
  /// @throws InputError if the graph differs; NumericalError, InternalError.
  virtual void refactor(const LocalMatrix& matrix, const Kernel& kernel) = 0;

  /// Of the sparse factors.
  virtual FactorizationCounts counts() const = 0;
};

/// What the making of a local inverse needs to know.
struct LocalInverseSettings {
  Precision precision = Precision::Double; ///< of dense blocks, or of sparse factors
  SparseSolverChoice solver;               ///< names of Amesos2 are for the implicit form alone
  int fixingPlaces = 4;                    ///< see fixingDofs()
  bool keepSchur = false; ///< the condensed form is to keep S, dense, for a Dirichlet preconditioner
};

/// K⁺ = (K + VVᵀ)⁻¹ by a sparse Cholesky factorisation; see regularized(). A product on the boundary
/// is a solve.
///
/// With Precision::Single the factors are in single precision, and each solve is followed by one step of
/// iterative refinement with a residual in double.
/// @param boundary rising. @param fixedBy the kernel, or one like it, by which dofs are chosen that hold it;
/// null: the kernel.
std::unique_ptr<LocalInverse> makeImplicitInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                  const std::vector<int>& boundary,
                                                  const LocalInverseSettings& settings,
                                                  std::shared_ptr<FactorizationContext> context,
                                                  const Kernel* fixedBy = nullptr);

/// With S the Schur complement on b and R_b the rows of the kernel there,
///
///     (K⁺)_bb = S⁺ = (S + VVᵀ)⁻¹,   u_b = S⁺(f_b − K_bi K_ii⁻¹ f_i),   u_i = K_ii⁻¹(f_i − K_ib u_b)
///
/// V see regularization(). S⁺ is a dense matrix: a product on the boundary is one with it. Needs R_b of full
/// column rank; see boundaryWithSupport().
/// @param boundary rising. @param columns how many vectors a product on the boundary usually has.
std::unique_ptr<LocalInverse> makeCondensedInverse(const LocalMatrix& matrix, const Kernel& kernel,
                                                   const std::vector<int>& boundary, int columns,
                                                   const LocalInverseSettings& settings,
                                                   std::shared_ptr<FactorizationContext> context);

/// The boundary, extended by fixing dofs where it alone would not hold the kernel (a subdomain that is
/// touched at one node) or where it is empty.
std::vector<int> boundaryWithSupport(const LocalMatrix& matrix, const Kernel& kernel,
                                     const std::vector<int>& boundary, int fixingPlaces);

} // namespace Harmos::feti
