// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOptions.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SolverOptions.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>

namespace Harmos::scene {

/// What the tolerance is.
enum class ToleranceRule {
  Fixed,   ///< ε as given
  Balanced ///< such that the solver's error is a given share of the discretisation error; see AnswerCheck
};

/// The lists of a deck that every application shares: Decomposition, Dual operator, Solver, Output. Its
/// tolerance is that of the rule Fixed.
struct RunOptions : feti::SolverOptions {
  feti::DirichletForm dirichlet = feti::DirichletForm::Primal;
  feti::DualOptions dual;
  ToleranceRule toleranceRule = ToleranceRule::Fixed;
  double solverErrorShare = 0.3; ///< of the rule Balanced
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
