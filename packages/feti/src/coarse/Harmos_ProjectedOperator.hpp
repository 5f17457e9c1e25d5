// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseSpace.hpp"
#include "Harmos_EndomorphicOperator.hpp"

namespace Harmos::feti {

/// PFP as a Tpetra operator; or PF, which is the same on vectors with Gλ = 0 and saves a reduction.
class ProjectedOperator : public EndomorphicOperator {
 public:
  ProjectedOperator(const Operator& inner, const CoarseSpace& coarse, bool onKernel = false)
      : EndomorphicOperator(inner), coarse_(coarse), onKernel_(onKernel) {}

 private:
  void applyTo(const MultiVector& X, MultiVector& Y) const override;
  const CoarseSpace& coarse_;
  bool onKernel_;
};

} // namespace Harmos::feti
