// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestScene.hpp"

#include <functional>

namespace Harmos {

// What tests ask of runs with friction, from their results alone.

/// How many contact points are in a state. Local; every rank has the same report.
long long countOf(const run::RunReport& report, run::Friction state);

/// Tresca's law at each point: |λ_t| ≤ g, and a slip only where they are equal, along the force. Of runs of
/// one step, since slips are those from the beginning.
/// @param bound by the position of the point. @param slipTolerance of a point that sticks, and across the
/// force.
void expectTrescasLaw(const run::RunReport& report, const std::function<double(const fem::Point&)>& bound,
                      double slipTolerance);

/// Coulomb's law likewise, with the bounds that the pressures of the same answer give.
void expectCoulombsLaw(const run::RunReport& report, double coefficient, double slipTolerance);

/// Of the displacements of two runs that are cut and distributed alike. @note Collective.
double largestDifference(const TestRun& a, const TestRun& b);

} // namespace Harmos
