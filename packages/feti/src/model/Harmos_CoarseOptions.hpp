// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseModel.hpp"

namespace Harmos::feti {

/// How the coarse problem is solved: "Decomposition/Coarse problem" of a deck.
struct CoarseOptions {
  enum class Form {
    Auto, ///< by the cost model: CoarseModel
    Replicated,
    Distributed
  };
  Form form = Form::Auto;
  /// Of a distributed one: what each rank keeps; see DistributedFactor.
  enum class Inverse {
    Auto, ///< by the cost model
    Rows,
    Solves
  };
  Inverse inverse = Inverse::Auto;
  int groupRanks = 0; ///< DistributedGraph's; 0: by the cost model
  CoarseRates rates;  ///< of the cost model
};

/// Whether a coarse problem of that shape is distributed: as was asked for, or by the cost model.
bool takesDistributed(const CoarseOptions& options, const CoarseShape& shape);

} // namespace Harmos::feti
