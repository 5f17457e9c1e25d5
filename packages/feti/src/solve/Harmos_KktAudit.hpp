// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Recovery.hpp"

namespace Harmos::feti {

/// The optimality conditions of the torn problem, computed from K, f, B, u and λ alone: an independent check
/// of everything between them. In physical units, not those of scaled rows.
struct KktAudit {
  double equilibrium = 0.0; ///< ‖Ku − f + Bᵀλ‖ / max(‖Ku‖, ‖f‖, ‖Bᵀλ‖, 1e-12 ‖diag(K)u‖)
  double gluingJump = 0.0; ///< ‖B_E u − c_E − Cλ_E‖_∞, of ties and prescribed values too
  /// Of soft rows, what is wrong with their springs: |Bu − c − Cλ − softness · λ| where they pull, and of
  /// limited ones always.
  double springError = 0.0;
  double springEnergy = 0.0;         ///< Σ½ softness · λ² of those
  double penetration = 0.0;          ///< max (B_I u − c_I − Cλ_I)₊
  double minContactMultiplier = 0.0; ///< min λ_I of rows that are not soft, 0 without inequalities
  double complementarity = 0.0;      ///< |λ_Iᵀ(B_I u − c_I)|
  /// Of limited rows, pair by pair: the largest Δs = Bu − c − Cλ where |λ| is below its limit; where it is
  /// not, of what is left of Δs without its part along λ.
  double slipError = 0.0;
  double limitExcess = 0.0;  ///< max (|λ| − limit)₊
  double largestLimit = 0.0; ///< of limited rows
  double frictionWork = 0.0; ///< Σ λᵀΔs of limited rows, which is dissipated
  double primalEnergy = 0.0; ///< ½uᵀKu − fᵀu, physical K and f (no trivial equations)
  /// ½uᵀKu − fᵀu + λᵀ(Bu − c): the same at the solution, but stationary there. Jumps of the order ε change
  /// the primal energy by λᵀ(Bu − c), of the order ε; the error of this is of the order ε².
  /// With rows that give way, ½λᵀCλ is stored in them, and springEnergy in soft ones.
  double energy = 0.0;
  double energyNorm = 0.0;          ///< √(uᵀKu)
  double largestDisplacement = 0.0; ///< ‖u‖_∞
  double forces = 0.0;              ///< what equilibrium is measured against
  double displacementForce = 0.0;   ///< ‖diag(K)u‖
  double unitForce = 0.0;           ///< ‖diag(K)‖, the same for displacements of one
  double displacementEnergy = 0.0; ///< √(uᵀ diag(K) u), that of moving each dof alone: the scale of rounding
  double unitEnergy = 0.0;         ///< √(tr K), the same for displacements of one
  double largestMultiplier = 0.0; ///< max |λ_I|, physical
  double largestRowForce = 0.0;   ///< the same of all given rows, by their coefficients as they were given
  // What loads would do to each dof alone, f_j/k_jj: the scale of rounding where they move nothing.
  double loadDisplacement = 0.0; ///< the largest
  double loadEnergy = 0.0;       ///< √Σ f_j²/k_jj
};

/// @note Collective.
/// Guarded by tests/unit/feti/test_mixed_inverses.cpp: it objects to a wrong answer that the solver believes.
KktAudit audit(const SubdomainSystem& system, const Constraints& constraints, const TornSolution& solution);

/// What an answer is measured against.
struct AuditLimits {
  double share;               ///< of the largest displacement and of the forces, see auditShare()
  double boundRounding = 0.0; ///< see Constraints::boundRounding()
  double inverseDefect = 0.0; ///< see LocalInverses::defect(), of all ranks
  double energyError = 0.0;   ///< as estimated, where it was
  double energyShare = 0.0;   ///< of the energy norm
};
/// Whether an audit bears out an answer: jumps and penetrations are at most a share of the largest
/// displacement, penetrations beside what the bounds are known to; so are slips that are none, and forces
/// keep within their limits to rounding; and so is what is wrong with springs; the error in the energy norm,
/// where it was estimated, is at most a share of its own of that of the solution, beside rounding. Forces are
/// out of balance by three tolerances, 0.03 of the share, at most: the solver leaves ‖G̃λ − ẽ‖ ≤ ε‖λ‖ on rigid
/// motions, for ‖G‖ = 1 and ‖G̃‖ ≤ ‖B‖ = 1, and with weights the same in other units; beside what inverses and
/// rounding leave of the rest. A number that is none objects.
bool auditAgrees(const KktAudit& audit, const AuditLimits& limits);

/// The share for a relative tolerance of the residuals: these and the audit are about the same errors in
/// other units, and a factor of a hundred is beyond what norms and scalings explain; a tenth of the solution
/// is too much by any tolerance.
double auditShare(double tolerance);

/// The same for the error in the energy norm, whose estimate is sharp to a factor of two: 30. An answer does
/// not depend on the way to it by more, whatever the solver, and energies not by more than 1000 ε².
double energyErrorShare(double tolerance);

/// Physical values of each owned limited row, in the order of rowMap(): Δs = Bu − c − Cλ and λ; of soft ones
/// what their springs are stretched by.
struct FrictionState {
  std::vector<long long> row; ///< number of the given row
  std::vector<double> slip;
  std::vector<double> force;
};

/// @note Collective.
FrictionState frictionState(const Constraints& constraints, const TornSolution& solution);

/// Physical value of each owned inequality row, in the order of rowMap(): the gap c_I − B_I u, with rows that
/// give way what is left of it, c_I + Cλ_I − B_I u, and the contact force λ_I. Springs of soft rows open
/// gaps.
struct ContactState {
  std::vector<long long> row; ///< number of the given inequality
  std::vector<double> gap;
  std::vector<double> force;
};

/// @note Collective.
ContactState contactState(const Constraints& constraints, const TornSolution& solution);

} // namespace Harmos::feti
