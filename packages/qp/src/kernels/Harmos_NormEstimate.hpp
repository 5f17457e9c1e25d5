// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_RCP.hpp>

#include <functional>

namespace Harmos::qp {

/// Estimate of ‖A‖ of a symmetric positive semidefinite operator by the Lanczos method.
///
/// The largest Ritz value θ alone underestimates; θ plus the norm of its residual lies above an eigenvalue
/// near θ (Parlett, The Symmetric Eigenvalue Problem, 1998, section 4.5), which for a start vector with a
/// part in every eigenspace is the largest one in all but contrived cases. It stops as soon as that residual
/// is below 2 % of θ. A caller must still be ready to meet a larger curvature and correct the estimate.
///
/// @param apply y = A x; @param start a non-zero vector, overwritten; @param mostApplications at least 1.
/// @param applications counts the products made, on top of its value.
/// @return 0 for A = 0 on the start vector.
/// @note Collective.
template<class Scalar, class MV>
double estimateNorm(const std::function<void(const MV&, MV&)>& apply, MV& start, int mostApplications,
                    int& applications);

} // namespace Harmos::qp
