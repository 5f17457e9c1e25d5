// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_OwnedSubdomain.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Gives copies of a node their mean. @param values of all dofs = node · components + component.
/// @return the largest change, of all ranks. @note Collective.
double joinCopies(const Teuchos::Comm<int>& comm, int components, const std::vector<OwnedSubdomain>& owned,
                  feti::TornVector& values);

/// Gives copies of a node their sum: what is shared among them, as loads and masses are, in full.
/// @note Collective.
void addCopies(const Teuchos::Comm<int>& comm, int components, const std::vector<OwnedSubdomain>& owned,
               feti::TornVector& values);

} // namespace Harmos::scene
