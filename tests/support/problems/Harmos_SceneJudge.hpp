// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestScene.hpp"

namespace Harmos {

/// What is wrong with the answer of a run, by the equations of the bodies before they are torn: an
/// independent judgement that uses neither the constraints B, nor multipliers of gluing, nor the audit of the
/// run.
///
/// From the scene it takes the stiffness and load of each piece of a body and the conditions n·w ≤ g, w = 0
/// of contact and ties; from the run displacements and contact forces.
struct Judgement {
  double displacement = 0.0;    ///< ‖u‖_∞
  double tear = 0.0;            ///< largest difference of copies of a node
  double prescribed = 0.0;      ///< largest error of a prescribed value
  double tieJump = 0.0;         ///< largest |w| of ties
  double penetration = 0.0;     ///< max (n·w − g)₊
  double pull = 0.0;            ///< largest contact force of the wrong sign, relative to the largest
  double forceAtDistance = 0.0; ///< Σ λ|g − n·w| / Σ λ: distance over which contact acts, in the mean
  double overLimit = 0.0;   ///< largest (|λ_t| − g)₊ of friction, relative to the largest contact force
  double slipAgainst = 0.0; ///< Σ (g|w_t| − λ_t·w_t) / Σ g: slip that is not along the force
  /// ‖Ku − f + contact, friction and tie forces‖ on dofs that are not prescribed, less its rounding errors,
  /// relative to the largest of ‖Ku‖, ‖f‖ and the contact forces.
  double imbalance = 0.0;
  double energy = 0.0;         ///< ½uᵀKu − fᵀu
  double energyScale = 0.0;    ///< the larger of ½uᵀKu and Σ |f_j u_j|
  double energyRounding = 0.0; ///< what rounding errors of u may change; not small beside large rigid motions
};

/// The same on every rank. @note Collective; rank 0 makes the whole scene and judges it.
Judgement judge(const scene::Scene& scene, const TestRun& run);

} // namespace Harmos
