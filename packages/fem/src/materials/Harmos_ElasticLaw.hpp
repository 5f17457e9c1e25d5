// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_MaterialLaw.hpp"

namespace Harmos::fem {

/// The stress of an elastic material at finite strains, W(E) of Green's strain E = ½(FᵀF − I) (Bonet, Wood:
/// Nonlinear Continuum Mechanics for Finite Element Analysis, 2008, chapter 6):
///
///     linear (St. Venant–Kirchhoff)  W = ½E:C:E, C of any symmetry
///     neo-Hookean                    W = ½μ(tr C − 3) − μ ln J + ½λ ln²J,  C = FᵀF, J² = det C
///
/// A material that is warmer has stress where it is held in its free expansion F_θ = I + ε_θ, symmetric: with
/// F = F_e F_θ the energy is det F_θ W(E_e), E_e = F_θ⁻¹(E − ½(F_θ² − I))F_θ⁻¹ (Lubarda: Constitutive
/// theories based on the multiplicative decomposition of deformation gradient, Appl. Mech. Rev. 57, 2004).
///
/// Of small strains both are σ = C(ε − ε_θ). Both have the stiffness of Material at E = 0. Strains and
/// stresses as in Voigt: shear strains are twice the tensor's. The first compresses without end under finite
/// pressure: it is one of small strains.
///
/// Guarded by tests/unit/fem/test_finite_elasticity.cpp.
class ElasticLaw : public MaterialLaw {
 public:
  ElasticLaw(const Material& material, Kinematics kinematics, Strains strains = Strains::Finite);

  /// @param strain E; in plane stress without use of its entry zz. @param rise of the temperature.
  /// @return an energy that is no number where C, or the free expansion, is not positive definite. Local.
  MaterialResponse at(const Voigt& strain, double rise = 0.0) const;
  MaterialResponse at(const Voigt& strain, double rise, const double* /*before*/,
                      double* /*after*/) const override {
    return at(strain, rise);
  }

 private:
  MaterialResponse withoutRise(const Voigt& strain) const;
  MaterialResponse small(const Voigt& strain, double rise) const;
  MaterialResponse linear(const Voigt& strain) const;
  MaterialResponse neoHookean(const Voigt& strain) const;
  double stretchWithoutStress(const Voigt& strain) const;

  Kinematics kinematics_;
  Strains strains_;
  Material::Law law_;
  VoigtMatrix stiffness_; // of the kinematics
  Voigt acrossBy_{};      // E_zz by the other strains, plane stress
  double lambda_, shear_; // Lamé's, of neo-Hookean materials
  Voigt expansion_;       // ε_θ of one degree
};

/// What a Newton iteration takes for the tangent that has the rigid motions of the deformed body as its
/// kernel: with δu = d + w, the symmetric and the other part of its gradient in the deformed body, that part
/// of the second variation of the energy that is of d alone,
///
///     δE:∂S/∂E:δE + tr(dτd) = δE:(∂S/∂E + H):δE,   δE:H:δE = tr(δE S δE C⁻¹),
///
/// where it is positive definite; else ∂S/∂E, and where it yields with as much more as makes it so. @param
/// strain that the response is to.
VoigtMatrix strainTangent(const MaterialResponse& response, const Voigt& strain, Kinematics kinematics);

} // namespace Harmos::fem
