// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <string>

namespace Harmos::app {

/// What a scene is made from.
struct DeckContext {
  const Teuchos::Comm<int>& comm;
  const Teuchos::ParameterList& deck; ///< validated
  std::string directory;              ///< of the deck, with a slash: what its file names are relative to
  const Log& log;
};

/// What distinguishes one application from another: its part of the deck, and the scene it makes of it.
struct Application {
  std::string name;
  std::string description;
  std::function<void(ParameterSpec&)> addParameters;
  /// Collective: meshes may have to be read. Errors are to be agreed on.
  std::function<scene::Scene(const DeckContext&)> makeScene;
  /// Puts what the application alone can say of a finished run into report.results; may be null. Local; every
  /// rank has the same report.
  std::function<void(const Teuchos::ParameterList&, scene::RunReport&)> evaluate;
  /// The effects that its decks may name, for --list-effects; null if its decks name none.
  const scene::EffectRegistry* effects = nullptr;
};

/// The command line, the deck, the run, the summary and the exit status that all applications share.
///
/// Exit status: 0 converged; 1 not converged or no solution; 2 bad input; 3 internal error. Initialises and
/// finalises MPI and Kokkos. Errors are printed once, by rank 0, on the standard error stream.
int main(int argc, char** argv, const Application& application);

} // namespace Harmos::app
