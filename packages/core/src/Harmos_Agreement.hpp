// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Errors.hpp"

#include <Teuchos_Comm.hpp>

#include <exception>
#include <utility>

namespace Harmos {

/// Throws the same error on every rank if any rank brings a failure.
///
/// The failure of the lowest failing rank is the one that is thrown; its message is extended by that rank's
/// number and by how many ranks failed with it, when there is more than one rank.
///
/// @param failure the exception caught on this rank, or null.
/// @throws the agreed error, of its own type, on all ranks.
/// @note Collective: one reduction, and three broadcasts after a failure.
void agreeOnFailure(const Teuchos::Comm<int>& comm, const std::exception_ptr& failure);

/// Runs rank-local work and makes its failure everybody's, before the next collective call.
///
/// The work itself must not communicate: a rank that fails would leave the others waiting.
/// Guarded by tests/unit/core/test_agreement.cpp.
/// @note Collective.
template<class Work>
void agree(const Teuchos::Comm<int>& comm, Work&& work) {
  std::exception_ptr failure;
  try {
    std::forward<Work>(work)();
  } catch (...) {
    failure = std::current_exception();
  }
  agreeOnFailure(comm, failure);
}

} // namespace Harmos
