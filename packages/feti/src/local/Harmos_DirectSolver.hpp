// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Types.hpp"

// Amesos2 has no header with declarations only.
namespace Amesos2 {
template<class Matrix, class Vector>
class Solver;
}

namespace Harmos::feti {

using Harmos::CrsMatrix;
/// A direct solver behind Amesos2's interface: one of Amesos2's own, or that of makeMumpsSolver().
using DirectSolver = Amesos2::Solver<CrsMatrix, MultiVector>;

} // namespace Harmos::feti
