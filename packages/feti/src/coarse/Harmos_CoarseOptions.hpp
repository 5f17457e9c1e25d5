// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CoarseModel.hpp"

#include <memory>

namespace Harmos::feti {

class CoarseSpace;
class Constraints;
class RigidMotions;

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

/// The coarse space in the form that was asked for, or by the cost model. Where the form is left open and a
/// distributed one proves too inaccurate, it is the replicated one.
/// @throws NumericalError on all ranks if a distributed one was asked for and proves so. @note Collective.
std::unique_ptr<CoarseSpace> makeCoarseSpace(const RigidMotions& motions, const Constraints& constraints,
                                             const CoarseOptions& options = {});

} // namespace Harmos::feti
