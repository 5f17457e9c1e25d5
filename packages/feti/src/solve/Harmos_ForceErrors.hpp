// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Constraints.hpp"

#include <Teuchos_RCP.hpp>

#include <vector>

namespace Harmos::feti {

/// The forces of a group of given rows, a contact for instance, and how wrong they are.
struct ForceError {
  double force = 0.0; ///< ‖λ‖ of the group's rows, physical
  double error = 0.0; ///< an estimate of ‖λ − λ*‖ of the same rows
  // Of its rows with an area, a tenth of the largest one at least; 0 where none has one.
  double traction = 0.0;      ///< max |λ|/area
  double tractionError = 0.0; ///< max |λ − λ*|/area, by the same estimate
  double smallestArea = 0.0;
  /// error/force; 0 where there is no error, infinite where there are no forces.
  double relative() const;
  /// tractionError/traction, likewise.
  double relativeTraction() const;
};

/// Groups of the rows that this rank gave.
struct RowGroups {
  std::vector<int> of; ///< each row's, −1 for none
  int count = 0;
  /// Of each row, for its traction; 0: it has none. Empty: no row has one.
  std::vector<double> areas;
};

/// Multipliers of an answer, and the estimate M⁻¹r of what is wrong with each of them; see forceErrors().
struct RowForces {
  Teuchos::RCP<MultiVector> multiplier, error;
};

/// @param jumps r, see keepErrors(). @param correction M⁻¹r. Copies.
RowForces rowForces(const Constraints& constraints, const MultiVector& multiplier, const MultiVector& jumps,
                    const MultiVector& correction);

/// By how much multipliers are wrong, group by group. The stopping rule measures the residual r = Bu − c of
/// all rows against the whole load; a small contact in a large body may have errors as large as its forces
/// then.
///
/// F(λ − λ*) = r on the rows that hold, so that the error is F⁻¹r about, and the preconditioner is F⁻¹ about:
/// M⁻¹r, of the rows of a group that hold or are violated. No contact loses more force than it has, and a
/// spring changes its force by |r| over its softness at most. F⁻¹ is local: what is wrong far away shows in r
/// there, and hardly here. Beside the error from a solution to 1e-12 the estimate was 0.4 to 4 times as large
/// in cracks, punches, pins, Hertz' problems and composites, at tolerances of 1e-2 to 1e-6; 0.2 where faults
/// are still to be found of which set of rows holds, and 12 to 27 times on a tie of meshes that do not match.
///
/// Tractions are looked at by themselves: in the norm over all nodes those at corners, whose share of the
/// area is small, hardly count. What is wrong at single nodes the estimate sees least: at corners of surfaces
/// of second order a tenth of it. So an answer before, from which the solver went on, measures the estimate:
/// by as much as a traction has moved farther than was estimated, up to ten times, its estimate is taken to
/// be too small. Of 600 scenes of tests/verification/interfaces, two were accepted with tractions wrong by 15
/// and 17 %, estimated at 3 %; with this they were estimated at 11 and 15 %, and not accepted.
///
/// @param before an answer that was worse; null without.
/// @return of each group, the same on all ranks. @note Collective.
/// Guarded by tests/unit/feti/solve/test_force_errors.cpp.
std::vector<ForceError> forceErrors(const Constraints& constraints, const RowForces& now,
                                    const RowForces* before, const RowGroups& groups);

} // namespace Harmos::feti
