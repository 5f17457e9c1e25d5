// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::effects {

/// How an interface of springs breaks, at a point: one damage d from 0 to 1 for both directions, which the
/// caller lets grow only (Alfano, Crisfield: Int. J. Numer. Meth. Engng. 50, 2001; Camanho, Dávila: NASA/TM
/// 2002-211737). With the energy that the opening δ_n and the slip δ_t would store in intact springs,
///
///     Y = ½(k_n⟨δ_n⟩² + k_t|δ_t|²),   e = √(2Y),   β = ½k_t|δ_t|²/Y,
///
/// (1 − d)Y is stored, Y is what a unit of damage releases, and ∫Y dd is dissipated, never negative.
///
/// Bilinear: d = e_f(e − e_0)/(e(e_f − e_0)) from e_0 on, where (t_n/σ)² + (t_t/τ)² = 1, up to e_f =
/// 2G_c/e_0, so that at constant β the energy G_c(β) is dissipated, by one of
///
///     ((1 − β)/G_I)^α + (β/G_II)^α = G_c^−α                  (power)
///     G_c = G_I + (G_II − G_I)β^η                            (Benzeggagh, Kenane: Compos. Sci. Technol. 56,
///     1996)
///
/// Brittle: d = 1 beyond e_0. All energies are per area, stiffnesses per area and opening.
///
/// All members are local. Guarded by tests/unit/effects/test_cohesive_law.cpp.
class CohesiveLaw {
 public:
  enum class Kind { Brittle, Bilinear };
  enum class MixedMode { Power, BenzeggaghKenane };
  struct Options {
    Kind kind = Kind::Bilinear;
    double normalStiffness = 0.0, tangentialStiffness = 0.0; ///< k_n, k_t > 0
    double normalStrength = 0.0, tangentialStrength = 0.0;   ///< σ, τ > 0
    double fractureEnergy = 0.0, fractureEnergyII = 0.0;     ///< G_I, G_II of the bilinear law
    MixedMode mixedMode = MixedMode::Power;
    double exponent = 1.0; ///< α, η > 0
  };

  /// @throws InputError for numbers that are not positive, and for energies so small that e_f ≤ e_0 for some
  /// β: the traction would fall faster than any opening can follow. It says the least admissible ones.
  explicit CohesiveLaw(const Options& options);

  const Options& options() const { return options_; }
  bool isBrittle() const { return options_.kind == Kind::Brittle; }

  /// How far a point has come.
  struct Opening {
    double size = 0.0;  ///< e, √(energy per area)
    double share = 0.0; ///< β, of mode II; 0 for a point that is closed
  };

  double onset(double share) const;          ///< e_0
  double end(double share) const;            ///< e_f; e_0 of the brittle law
  double fractureEnergy(double share) const; ///< G_c; ½e_0² of the brittle law

  /// d of a point that came from its intact state straight to an opening.
  double damage(const Opening& opening) const;
  /// The opening at which a point of the bilinear law gets a damage.
  double sizeAt(double damage, double share) const;
  /// ∫Y dd from the intact state to a damage, at constant β; G_c where that is 1.
  double dissipated(double damage, double share) const;

 private:
  void requirePositive() const;
  void requireNoSnap() const;

  Options options_;
};

} // namespace Harmos::effects
