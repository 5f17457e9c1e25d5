// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FetiAnswer.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::feti {

FetiAnswer::FetiAnswer() = default;
FetiAnswer::~FetiAnswer() = default;

const TornSolution& FetiAnswer::solution() const {
  if (!solution_)
    throw InputError("there is no solution yet; call solve() first");
  return *solution_;
}

} // namespace Harmos::feti
