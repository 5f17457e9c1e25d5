// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ActiveFace.hpp"
#include "Harmos_FeasibleSet.hpp"

#include <limits>
#include <vector>

namespace Harmos::qp {

/// What one pass over an iterate and its gradient yields; global, the same on all ranks.
struct SplitSums {
  double freeNorm2 = 0.0;    ///< φᵀφ
  double choppedNorm2 = 0.0; ///< βᵀβ
  double reducedNorm2 = 0.0; ///< φ̃ᵀφ
  double xNorm2 = 0.0;       ///< xᵀx
  long long active = 0;      ///< entries at a bound
  long long changed = 0;     ///< entries whose state differs from that in the given set
  /// Largest α with x − αp within the bounds, p the direction written in the same pass.
  double longestStep = std::numeric_limits<double>::infinity();

  double projectedNorm2() const { return freeNorm2 + choppedNorm2; }
};

/// What a product Hp is asked for; global.
struct CurvatureSums {
  double gradientDotDirection = 0.0; ///< gᵀp
  double directionDotImage = 0.0;    ///< pᵀHp
  double directionNorm2 = 0.0;       ///< pᵀp
  double freeDotImage = 0.0;         ///< φᵀHp
  double freeImageNorm2 = 0.0;       ///< ‖Hp‖² over the free entries
};

/// What a conjugate gradient step ends with; global.
struct ResidualSums {
  double residualNorm2 = 0.0;          ///< wᵀw
  double preconditionedDotImage = 0.0; ///< zᵀHp
  double iterateNorm2 = 0.0;           ///< xᵀx
};

/// A step from an old iterate to a new one; global.
struct ChangeSums {
  double cost = 0.0;          ///< f(x) − f(x_old) = ½(x − x_old)ᵀ(g + g_old), free of cancellation
  double moved2 = 0.0;        ///< ‖x − x_old‖²
  double gradientNorm2 = 0.0; ///< ‖g_old‖²
};

/// How a face differs from the one before; global. For violations, wrong signs and distances see FaceTally.
struct FaceChange {
  long long active = 0;  ///< held entries
  long long changed = 0; ///< entries, or pairs, whose part of the face is another one
  double violation2 = 0.0;
  double wrongSign2 = 0.0;
  double signature[2] = {0.0, 0.0}; ///< the same for the same face; differs with all but certainty else
  long long slips = 0;              ///< pairs
  double wrongForces2 = 0.0; ///< of ∇ψ(x) from what the springs of the face before make of it, squared
  double distance2 = 0.0;
};

/// What a residual w says of slipping pairs, with q for the diagonal of A; global.
struct SlipSums {
  double along2 = 0.0;                           ///< Σ(tᵀw)²
  double softened2 = 0.0;                        ///< Σ(q/(q + κ))²(tᵀw)²
  double springs2 = 0.0, softenedSprings2 = 0.0; ///< the same of springs, w in the place of tᵀw
  double rims2 = 0.0; ///< Σ((q + κ)r)²: where tᵀw is as large, tᵀy is off by about r
};

/// Infimum of wᵀx over the feasible set.
struct BoxInfimum {
  double value = 0.0;     ///< over entries whose bound is there
  double openNorm = 0.0;  ///< ‖w‖ over entries without the bound that w pushes against
  double boundNorm = 0.0; ///< ‖x‖ of the corner where the value is attained
};

/// A pair l_i > u_i, or a bound that is no number; of a disc, ∓ its radius where that is negative, and no
/// number where its entries have bounds of their own.
struct BoundFault {
  bool found = false;
  long long entry = -1; ///< global index, if the vector type has one
  double lower = 0.0;
  double upper = 0.0;
};

} // namespace Harmos::qp
