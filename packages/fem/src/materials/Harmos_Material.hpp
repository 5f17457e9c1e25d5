// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::fem {

/// What a cross-section may do.
enum class Kinematics {
  PlaneStrain,  ///< ε_zz = ε_xz = ε_yz = 0
  PlaneStress,  ///< σ_zz = σ_xz = σ_yz = 0
  Axisymmetric, ///< z is around the axis: ε_zz = u_x/x, ε_xz = ε_yz = 0
  Solid         ///< three dimensions
};

/// Stresses and strains in the order of VTK: xx, yy, zz, xy, yz, xz; shear strains are twice the tensor's.
using Voigt = std::array<double, 6>;
using VoigtMatrix = std::array<Voigt, 6>;

/// Von Mises' plasticity of an isotropic material, see PlasticLaw.
struct Plasticity {
  double yieldStress = 0.0; ///< above 0
  double isotropic = 0.0,
         kinematic = 0.0; ///< moduli: of the yield stress, and of the back stress, over e; 0: none
  /// Equivalent plastic strains, rising from 0, and the yield stresses there, not falling, in the place of
  /// the yield stress and the isotropic modulus.
  std::optional<std::array<std::vector<double>, 2>> curve = std::nullopt;
};

/// A linear elastic orthotropic material, its axes turned about z by an angle, or anywhere; or an anisotropic
/// one.
///
/// Compliance: ε_11 = σ_11/E_1 − ν_12 σ_22/E_1 − ν_13 σ_33/E_1, ..., γ_12 = σ_12/G_12, with
/// ν_ij/E_i = ν_ji/E_j (Jones: Mechanics of Composite Materials, 1999, section 2.3).
struct Material {
  /// Of finite strains, see ElasticLaw; of small ones both are the same.
  enum class Law { Linear, NeoHookean };

  std::array<double, 3> young = {1.0, 1.0, 1.0};                   ///< E_1, E_2, E_3
  std::array<double, 3> poisson = {0.3, 0.3, 0.3};                 ///< ν_12, ν_13, ν_23
  std::array<double, 3> shear = {1.0 / 2.6, 1.0 / 2.6, 1.0 / 2.6}; ///< G_12, G_13, G_23
  double angle = 0.0;                                              ///< of axis 1 from x, in radians
  std::array<double, 3> expansion = {0.0, 0.0, 0.0};               ///< thermal, along the axes
  /// Axes 1 and 2, of length one and at right angles, in the place of the angle.
  std::optional<std::array<std::array<double, 3>, 2>> axes = std::nullopt;
  /// C in the material's axes, of an anisotropic material: see anisotropic().
  std::optional<VoigtMatrix> coupled = std::nullopt;
  Law law = Law::Linear; ///< neo-Hookean: of isotropic materials
  std::optional<Plasticity> plasticity = std::nullopt;
  double density = 0.0; ///< mass per volume; 0: not given

  static Material isotropic(double young, double poisson);
  /// @param stiffness C, symmetric. Moduli and Poisson's ratios are those of its inverse.
  /// @throws InputError if it is not positive definite.
  static Material anisotropic(const VoigtMatrix& stiffness);
  /// The same with axes along the first direction, and that part of the second that is at right angles.
  /// @throws InputError for directions that are zero or parallel.
  Material turnedTo(const std::array<double, 3>& first, const std::array<double, 3>& second) const;
  /// @throws InputError, naming the material and the value that is out of range: moduli not positive or not
  /// finite, or an energy that is not positive definite (isotropic: −1 < ν < 0.5).
  void check(const std::string& name) const;

  /// σ = C ε of the solid or the cross-section. For plane stress the rows and columns zz, yz, xz are zero.
  VoigtMatrix stiffness(Kinematics kinematics) const;
  /// Strain of free expansion by one degree.
  Voigt thermalStrain() const;
};

/// Whether a Poisson's ratio is above 0.4: from there on elements of the first order lose accuracy noticeably
/// unless their dilatation is projected.
bool nearlyIncompressible(const Material& material);

} // namespace Harmos::fem
