// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundedLagrangian.hpp"
#include "Harmos_SolverManager.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <functional>

namespace Harmos::qp {

/// What the solvers with bounds share: the inner loop over MPRGP steps and the reasons for its end.
template<class Scalar, class MV, class OP>
class BoundedSolver : public SolverManager<Scalar, MV, OP> {
 protected:
  using Lagrangian = BoundedLagrangian<Scalar, MV, OP>;
  using Rows = EqualityRows<Scalar, MV, OP>;
  using State = IterationState<MV>;

  /// Minimises L(·, μ, ρ) until the convergence test passes, the caller's precision is reached, or it fails.
  ///
  /// @param state of the current iterate; of the last one on return.
  /// @param precise the inner stop; null for none. @param precision M, for the history alone.
  /// @return true if the caller may go on with its outer iteration; false if the solver has stopped, with the
  ///         reason set.
  bool minimise(Lagrangian& lagrangian, State& state, const std::function<bool(const State&)>& precise,
                double precision);

  /// Makes the Lagrangian and the first state; or those of the run that this one goes on from.
  /// @param own what the caller knows beyond the Lagrangian, where there is more; to live as long as
  /// minimise() is used.
  State begin(Lagrangian& lagrangian, double penalty, double precision,
              const std::function<void(StateArchive<MV>&)>& own = nullptr);

  /// Looks for a proof that the constraints contradict each other; stops the solver if there is one.
  /// @param feasible is set where they are found not to.
  bool stopIfInfeasible(Rows& rows, int mostSteps, bool& feasible);

 private:
  int outer_ = 0, inner_ = 0; // of the state that minimise() is about to leave
};

} // namespace Harmos::qp
