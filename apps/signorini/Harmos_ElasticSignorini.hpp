// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

namespace Harmos::signorini {

/// Elastic bodies on a rigid plane, of a deck with the lists Model and Material.

/// A heavy square or cube of side one on the plane, held sideways at the left, pulled up at the right by a
/// quarter of its weight: it lifts off there. Vertically it is held by the contact alone.
scene::Scene block(const Teuchos::ParameterList& deck);

/// A disc (plane strain) or ball of radius one between two rigid plates that approach each other: by symmetry
/// a quarter or an eighth of it, whose middle plane moves towards the plate below by the approach. Elements
/// are the finer the closer they are to the point of contact.
scene::Scene hertz(const Teuchos::ParameterList& deck, bool isBall);

/// Puts load, contact half-width, peak pressure and approach of a Hertz problem into the results, each beside
/// what theory says for that load.
///
/// Cylinder: a² = 4PR/(πE*), p₀ = 2P/(πa), δ = P/(πE*) (2 ln(4R/a) − 1); ball: a³ = 3PR/(4E*),
/// p₀ = 3P/(2πa²), δ = a²/R − P/(πE) (2(1 + ν)R²/(a² + 4R²)^{3/2} + (1 − ν²)/(a² + 4R²)^{1/2});
/// E* = E/(1 − ν²) (Johnson: Contact Mechanics, 1985, sections 4.2, 5.6; the part of the other plate in the
/// ball's approach: Tatara, J. Eng. Mater. Technol. 113, 1991).
/// The half-width of a computed solution is that of the Hertz pressure with the same second moment:
/// ∫p x² = P a²/4 for the cylinder, ∫p r² = 2P a²/5 for the ball.
/// @note Collective.
void evaluateHertz(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck, bool isBall,
                   run::RunReport& report);

} // namespace Harmos::signorini
