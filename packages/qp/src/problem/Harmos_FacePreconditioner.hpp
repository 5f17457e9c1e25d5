// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_RCP.hpp>

namespace Harmos::qp {

/// Makes preconditioners for the faces a bound-constrained solver works in; implemented by applications.
///
/// A face leaves some entries free and holds the others at their bounds; what is wanted is an approximation
/// of (A_FF)⁻¹. MPRGP asks for one when it starts a conjugate gradient sequence in a face other than the
/// last, PDAS for each active set: reuse what does not depend on the face (graphs, aggregates, orderings).
///
/// Guarded by tests/verification/test_obstacle.cpp.
template<class MV, class OP>
class FacePreconditioner {
 public:
  virtual ~FacePreconditioner() = default;

  /// @param free 1 at free entries, 0 elsewhere.
  /// @return an operator on vectors of the full length, symmetric positive definite on the free entries; it
  /// is
  ///         given zeros elsewhere, and what it returns there is not looked at.
  /// @note Collective.
  virtual Teuchos::RCP<const OP> build(const MV& free) = 0;
};

} // namespace Harmos::qp
