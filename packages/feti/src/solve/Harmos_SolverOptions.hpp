// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ParameterSpec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>

namespace Harmos::feti {

/// What the residuals are measured against; R with orthonormal columns.
enum class StoppingRule {
  Scaled, ///< ‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε max(‖λ̃‖, ‖λ + λ̃‖)
  Paper, ///< ‖g^P‖ ≤ ε‖d‖ and ‖Gλ‖ ≤ ε‖(G̃G̃ᵀ)⁻¹ẽ‖ (Dostál, Horák, Vlach, section 5)
  Permon ///< ‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε‖Pd‖
};

/// The first iterate λ⁰, before it is projected onto the bounds.
enum class InitialGuess {
  Zero,
  HalfLoad ///< ½Bf (Dostál, Horák, Vlach, section 5)
};

/// What the tolerance is.
enum class ToleranceRule {
  Fixed,   ///< ε as given
  Balanced ///< such that the solver's error is a given share of the discretisation error; see AnswerJudge
};

/// The list "Solver": how the dual problem is solved.
struct SolverOptions {
  double tolerance = 1e-4; ///< of the rule Fixed
  ToleranceRule toleranceRule = ToleranceRule::Fixed;
  double solverErrorShare = 0.3; ///< of the rule Balanced
  StoppingRule stoppingRule = StoppingRule::Scaled;
  InitialGuess initialGuess = InitialGuess::Zero;
  std::string method = "Auto";
  double maximumSeconds = 0.0;
  int maximumIterations = 10000;
  int progressFrequency = 10;
  Teuchos::ParameterList methodLists; ///< sublists of the methods
  /// The one that is solved to; 0 where the rule decides as it goes on.
  double fixedTolerance() const { return toleranceRule == ToleranceRule::Fixed ? tolerance : 0.0; }

  /// Adds the parameters to a list's specification.
  static void addTo(ParameterSpec& solver);
  /// From a validated list.
  static SolverOptions fromList(const Teuchos::ParameterList& solver);
};

/// As decks call them.
std::string toString(ToleranceRule rule);
std::string toString(StoppingRule rule);

} // namespace Harmos::feti
