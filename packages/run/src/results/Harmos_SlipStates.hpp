// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_KktAudit.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// What the limited rows of a scene's friction answer: by their numbers, the same on every rank.
struct RowSlip {
  double slip = 0.0;  ///< Δs of the step, of the first body against the second
  double force = 0.0; ///< λ, parallel to it
};

/// @note Collective; the rows are gathered on every rank.
std::vector<RowSlip> rowSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                              const feti::FrictionState& state);

/// c_t of the limited rows among those that this rank gives, by their numbers: the slips when the step began.
/// @note Collective.
std::vector<double> slipsBefore(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                                const std::vector<ConstraintRow>& rows);

/// Brings both to the points that bear friction. Local.
/// @param before of each row, or empty: zeros.
void addSlips(const scene::ContactSetup& contact, const std::vector<RowSlip>& slips,
              const std::vector<double>& before, std::vector<ContactState>& states);

} // namespace Harmos::run
