// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"

namespace Harmos::qp {

/// A Krylov method for the linear problem on a face, a step at a time: x, its gradients and what is known of
/// them (FaceIterate) go along.
template<class MV>
class Krylov {
 public:
  /// Flat: the matrix vanishes along the direction, or nothing is left that a step would take away.
  enum class Outcome { Step, Flat, Breakdown };

  virtual ~Krylov() = default;

  /// Directions were those of another face. Local.
  virtual void forget() = 0;
  /// From an iterate whose gradients were computed anew. @note Collective.
  virtual void begin() = 0;
  /// @note Collective.
  virtual Outcome step() = 0;
  /// Directions, and all that steps need beside the iterate. @note Collective.
  virtual void exchange(StateArchive<MV>& archive) = 0;
};

} // namespace Harmos::qp
