// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseOptions.hpp"

namespace Harmos::feti {

bool takesDistributed(const CoarseOptions& options, const CoarseShape& shape) {
  using Form = CoarseOptions::Form;
  return options.form == Form::Distributed ||
         (options.form == Form::Auto && isDistributedCheaper(shape, options.rates));
}

} // namespace Harmos::feti
