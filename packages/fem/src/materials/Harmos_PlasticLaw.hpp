// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_HardeningCurve.hpp"
#include "Harmos_MaterialLaw.hpp"
#include "Harmos_Tensors.hpp"

namespace Harmos::fem {

/// Von Mises' plasticity with isotropic and linear kinematic hardening, associative, integrated by the radial
/// return with its consistent tangent (Simo, Hughes: Computational Inelasticity, 1998, box 3.2):
///
///     f = |dev σ − ⅔Kα| − √⅔ σ_y(e),   ε̇_p = α̇ = γ̇n,   ė = √⅔γ̇,   W = ½ε_e:C:ε_e + ⅓K|α|²,
///
/// and ∫₀ᵉ σ_y is dissipated. Of finite strains F = F_e F_p, with H = ½ ln F_p⁻ᵀCF_p⁻¹ in the place of ε −
/// ε_p and F_p ← exp(Δγn)F_p: the return is that of small strains (Simo: Comput. Methods Appl. Mech. Engrg.
/// 99, 1992; Miehe, Apel, Lambrecht 2002); elastic strains are Hencky's.
///
/// States: small ε_p (as α), e; finite F_p⁻¹ − I, α, e. Local. Guarded by tests/unit/fem/test_plasticity.cpp.
class PlasticLaw : public MaterialLaw {
 public:
  /// @param material isotropic, with Material::plasticity. In space, plane strain or around an axis; for
  /// plane stress see PlaneStressLaw.
  PlasticLaw(const Material& material, Strains strains);

  std::size_t stateSize() const override;
  MaterialResponse at(const Voigt& strain, double rise, const double* before, double* after) const override;
  double shownState(const double* state) const override { return state[stateSize() - 1]; }

 private:
  // Of an elastic strain, as if nothing flowed, to what remains of it.
  struct Return {
    Voigt stress{}, flow{}; // the flow as a strain
    VoigtMatrix tangent{};
    double equivalent = 0.0, energy = 0.0;
    bool yields = false;
  };
  Return returned(const Voigt& trial, const Voigt& kinematic, double equivalent) const;
  MaterialResponse small(const Voigt& strain, double rise, const double* before, double* after) const;
  MaterialResponse finite(const Voigt& strain, double rise, const double* before, double* after) const;

  Strains strains_;
  double bulk_, shear_, kinematic_, expansion_;
  HardeningCurve curve_;
};

} // namespace Harmos::fem
