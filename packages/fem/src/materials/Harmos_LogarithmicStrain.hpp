// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Material.hpp"
#include "Harmos_Tensors.hpp"

#include <array>

namespace Harmos::fem {

/// Eigenvalues of a symmetric tensor, and its eigenvectors as columns. By Jacobi's rotations.
struct Eigenpairs {
  std::array<double, 3> values{};
  Tensor vectors{};
};
Eigenpairs eigenpairsOf(const Tensor& symmetric);

/// exp of a symmetric tensor.
Tensor exponentialOf(const Tensor& symmetric);

/// H = ½ ln A of A = Gᵀ(I + 2E)G, and what its first two derivatives with respect to Green's strain E make of
/// a law of H (Miehe, Apel, Lambrecht: Comput. Methods Appl. Mech. Engrg. 191, 2002; derivatives of the
/// logarithm by divided differences: Daleckii, Krein 1965):
///
///     S = T : ∂H/∂E,   ∂S/∂E = (∂H/∂E)ᵀ : D : ∂H/∂E + T : ∂²H/∂E∂E.
///
/// Local. Guarded by tests/unit/fem/test_plasticity.cpp.
class LogarithmicStrain {
 public:
  /// @param strain E in Voigt's order. @param inverse G.
  LogarithmicStrain(const Voigt& strain, const Tensor& inverse);

  /// Whether A is positive definite; the rest is of no use else.
  bool isSound() const { return isSound_; }
  const Voigt& strain() const { return strain_; }
  /// @param stress T and @param tangent D of the law at H; they become S and ∂S/∂E.
  void pullBack(Voigt& stress, VoigtMatrix& tangent) const;

 private:
  bool isSound_ = false;
  Eigenpairs pairs_;
  Voigt strain_{};
  std::array<Tensor, 6> changes_{}; // ∂A of each strain, along the eigenvectors
};

} // namespace Harmos::fem
