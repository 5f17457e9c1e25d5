// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_KktAudit.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::run {

/// What the limited rows of a scene's friction answer: those of this rank's points, in their order.
struct RowSlip {
  double slip = 0.0;  ///< Δs of the step, of the first body against the second
  double force = 0.0; ///< λ, parallel to it
};

/// @note Collective: rows are where their subdomains are, points where they were found.
std::vector<RowSlip> rowSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
                              const feti::FrictionState& state);

/// c_t of the limited rows among those that this rank gives, in their order: the slips when the step began.
/// Local.
std::vector<double> slipsBefore(const std::vector<ConstraintRow>& rows);

/// Brings both to the points that bear friction. @note Collective, see tractions().
/// @param before of each row, or empty: zeros.
void addSlips(const Teuchos::Comm<int>& comm, const scene::ContactSetup& contact,
              const std::vector<RowSlip>& slips, const std::vector<double>& before,
              std::vector<ContactState>& states);

} // namespace Harmos::run
