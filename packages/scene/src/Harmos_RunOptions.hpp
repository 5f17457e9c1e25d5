// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOptions.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>

namespace Harmos::scene {

/// What the residuals are measured against; R with orthonormal columns.
enum class StoppingRule {
  Scaled, ///< ‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε max(‖λ̃‖, ‖λ + λ̃‖)
  Paper, ///< ‖g^P‖ ≤ ε‖d‖ and ‖Gλ‖ ≤ ε‖(G̃G̃ᵀ)⁻¹ẽ‖ (Dostál, Horák, Vlach, section 5)
  Permon ///< ‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε‖Pd‖
};

/// What the tolerance is.
enum class ToleranceRule {
  Fixed,   ///< ε as given
  Balanced ///< such that the solver's error is a given share of the discretisation error; see AnswerCheck
};

/// The first iterate λ⁰, before it is projected onto the bounds.
enum class InitialGuess {
  Zero,
  HalfLoad ///< ½Bf (Dostál, Horák, Vlach, section 5)
};

/// The lists of a deck that every application shares: Decomposition, Dual operator, Solver, Output.
struct RunOptions {
  feti::DirichletForm dirichlet = feti::DirichletForm::Primal;
  DualOptions dual;
  ToleranceRule toleranceRule = ToleranceRule::Fixed;
  double tolerance = 1e-4;       ///< of the rule Fixed
  double solverErrorShare = 0.3; ///< of the rule Balanced
  StoppingRule stoppingRule = StoppingRule::Scaled;
  InitialGuess initialGuess = InitialGuess::Zero;
  std::string method;
  double maximumSeconds = 0.0;
  int maximumIterations = 0;
  int progressFrequency = 0;
  Teuchos::ParameterList methodLists; ///< sublists MPRGP, SMALBE, Dual Penalty
  std::string outputDirectory;
  bool writeFields = true;
  bool writeStresses = true;

  /// Adds the lists to the specification of a deck.
  static void addTo(ParameterSpec& deck);
  /// From a validated deck.
  static RunOptions fromDeck(const Teuchos::ParameterList& deck);
};

/// Refuses options that contradict each other or the scene, before anything is computed.
/// @throws InputError
void checkConsistency(const Scene& scene, const RunOptions& options);

} // namespace Harmos::scene
