// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SubdomainSystem.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// A generalised inverse K⁺ of one subdomain matrix: K K⁺ K = K.
class LocalInverse {
 public:
  virtual ~LocalInverse() = default;

  /// x = K⁺b. @throws NumericalError, InternalError.
  virtual void apply(const double* b, double* x) const = 0;
};

/// One generalised inverse for every subdomain of a rank: the only one that F, d̃ and the recovery may use.
///
/// Different generalised inverses give different F and d̃ (only PFP and Pd agree). Whoever mixes them gets a
/// solver that converges to a wrong answer, which tests/unit/feti/test_mixed_inverses.cpp shows. Therefore
/// DualOperator, DualProblem and Recovery take this one object.
class LocalInverses {
 public:
  LocalInverses(std::vector<std::unique_ptr<LocalInverse>> inverses) : inverses_(std::move(inverses)) {}

  const LocalInverse& operator[](int i) const { return *inverses_[static_cast<std::size_t>(i)]; }
  int size() const { return static_cast<int>(inverses_.size()); }
  /// Factorisations held on this rank.
  int distinctFactorizations() const { return size(); }

  /// x_i = K_i⁺ b_i.
  TornVector apply(const TornVector& b) const;

 private:
  std::vector<std::unique_ptr<LocalInverse>> inverses_;
};

/// How the implicit inverses are made.
struct ImplicitInverseOptions {
  /// Fixing dofs for each kernel column; more spread the regularisation, one suffices in theory.
  int fixingDofsPerKernelColumn = 4;
};

/// K_i⁺ = (K_i + ρN(NᵀN)⁻¹Nᵀ)⁻¹ by sparse Cholesky factorisations with MUMPS behind Amesos2.
///
/// Each is verified with a fixed pseudo-random x: ‖K K⁺ K x − K x‖ ≤ 1e-8 ‖Kx‖. A disagreement, or a factor
/// that does not exist, means that the subdomain has more rigid motions than its kernel says; the error names
/// it.
/// @throws NumericalError on all ranks.
/// @note Collective.
/// Guarded by tests/unit/feti/test_local_inverse.cpp.
LocalInverses makeImplicitInverses(const SubdomainSystem& system, const ImplicitInverseOptions& options = {});

} // namespace Harmos::feti
