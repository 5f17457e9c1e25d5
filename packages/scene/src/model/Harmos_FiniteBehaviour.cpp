// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiniteBehaviour.hpp"

namespace Harmos::scene {

FiniteBehaviour::~FiniteBehaviour() = default;

void FiniteBehaviour::addFollowingLoad(const Scene&, const Deformed&, std::vector<double>&) const {}

std::string FiniteBehaviour::fault(const ConstraintCollector&) const {
  return {};
}

const FiniteBehaviour& FiniteBehaviour::plain() {
  static const FiniteBehaviour result;
  return result;
}

} // namespace Harmos::scene
