// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_InterfaceLaw.hpp"

#include <algorithm>

namespace Harmos::scene {

double InterfaceLaw::RowAnswer::opening() const {
  if (isLimited)
    return softness ? *softness * force + unstretched : -gap;
  return softness ? -*softness * std::min(force, 0.0) - unstretched : gap;
}

double InterfaceLaw::RowAnswer::hold() const {
  if (isLimited)
    return softness ? force : 0.0;
  return -force;
}

} // namespace Harmos::scene
