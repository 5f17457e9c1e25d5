// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Harmos::run {

/// The parameters of the generalised-α method (Chung, Hulbert, J. Appl. Mech. 60, 1993),
///
///     (1 − α_m)Ma₁ + α_m Ma₀ = (1 − α_f)i₁ + α_f i₀,   i = f − Ku − Bᵀλ,
///     u₁ = u₀ + Δt v₀ + Δt²((½ − β)a₀ + βa₁),   v₁ = v₀ + Δt((1 − γ)a₀ + γa₁)
///
/// by ρ∞, the spectral radius at infinite frequencies: 1 is Newmark's trapezoidal rule, which keeps energy;
/// less of it damps what steps do not resolve. Second order for every ρ∞.
struct GeneralisedAlpha {
  double alphaM, alphaF, beta, gamma;

  static GeneralisedAlpha of(double spectralRadius) {
    const double m = (2.0 * spectralRadius - 1.0) / (spectralRadius + 1.0),
                 f = spectralRadius / (spectralRadius + 1.0);
    return {m, f, 0.25 * (1.0 - m + f) * (1.0 - m + f), 0.5 - m + f};
  }
  /// One that takes forces of the end of a step alone: with a convex potential energy never rises, and
  /// motions that steps do not resolve are lost (contacts of Kane, Repetto, Ortiz, Marsden, 1999). First
  /// order.
  static GeneralisedAlpha damped() { return {0.0, 0.0, 0.5, 1.0}; }
  /// κ: the step has K + κM in the place of K.
  double massFactor(double step) const { return (1.0 - alphaM) / ((1.0 - alphaF) * beta * step * step); }
};

} // namespace Harmos::run
