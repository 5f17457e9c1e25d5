// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_EffectRegistry.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunPlan.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SizeField.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace Harmos::app {

/// What a scene is made from.
struct DeckContext {
  const Teuchos::Comm<int>& comm;
  const Teuchos::ParameterList& deck; ///< validated
  std::string directory;              ///< of the deck, with a slash: what its file names are relative to
  const Log& log;
  std::map<std::string, int> chosenSubdomains = {}; ///< of the run that this one goes on with
  /// Of the cells of geometries that are meshed; null: as these have them.
  std::shared_ptr<const fem::SizeField> sizes = nullptr;
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
  std::function<void(const Teuchos::Comm<int>&, const Teuchos::ParameterList&, run::RunReport&)> evaluate;
  /// The effects that its decks may name, for --list-effects; null if its decks name none.
  std::shared_ptr<const scene::EffectRegistry> effects;
  bool mayBeTransient = false; ///< whether its materials have densities
  bool mayAdapt = false;       ///< whether it reads geometries, which may be meshed anew
};

/// The command line, as far as a program has to know it.
struct CommandLine {
  std::string deck;
  std::vector<std::string> assignments; ///< "List/Sublist/Name=value"
  std::string output;                   ///< "": as the deck says
  std::string restart;                  ///< output directory of the run to go on from; "": none
  std::string printParameters;
  bool check = false;
  bool parts = false; ///< show the boundary parts, and stop
  bool plan = false;
  plan::PlanRequest planRequest; ///< of --plan
  bool listEffects = false;
  bool quiet = false;
  bool version = false;
};

/// What a program is given to do its work.
struct ProgramContext {
  Teuchos::RCP<const Teuchos::Comm<int>> comm;
  const CommandLine& line;
  const Log& log;
  std::chrono::steady_clock::time_point begin; ///< of the program
};

/// A program with a deck.
struct Program {
  std::string name;
  std::string description;
  std::function<ParameterSpec()> deckSpec;
  /// The work, collective; returns the exit status. Errors that it throws are printed by whoever called it.
  std::function<int(const ProgramContext&)> run;
  bool restarts = false; ///< has the option --restart
  std::shared_ptr<const scene::EffectRegistry> effects =
      nullptr;             ///< for --list-effects; null: it has no such option
  bool plans = false;      ///< whether it has --plan
  bool showsParts = false; ///< whether it has --parts
};

/// The deck of a program's command line, validated; names at old places are noted in the log.
/// @note Collective.
Teuchos::ParameterList readDeck(const ProgramContext& context, const ParameterSpec& spec);

/// The scene of an application's deck, with its timeline. @note Collective.
scene::Scene sceneOf(const Application& application, const DeckContext& context);

/// The whole deck of an application: its own part, and the lists that all share.
ParameterSpec deckSpec(const Application& application);

/// "path/of/" of "path/of/file"; "./" of "file".
std::string directoryOf(const std::string& file);

/// An internal error of this rank alone: the others do not know of it, and nothing collective may follow.
bool standsAlone(const Teuchos::Comm<int>& comm, const Error& error);

/// A run that failed leaves what is known of it: a summary with the cause. A rank that stands alone with its
/// fault writes by itself. @note Collective otherwise.
void leaveSummary(const ProgramContext& context, const run::RunOptions& options, run::RunReport& report,
                  const Error& error);

/// The work of an application's program: the deck, the run, the summary. A run that fails once its output
/// directory is there leaves a summary.json with the cause. @return the exit status. @throws whatever ended
/// the run.
/// @note Collective.
/// Guarded by tests/unit/apps/test_failed_run.cpp.
int runDeck(const Application& application, const ProgramContext& context);

/// The command line and the exit status that all programs share, see the other main().
int main(int argc, char** argv, const Program& program);

/// The command line, the deck, the run, the summary and the exit status that all applications share.
///
/// Exit status: 0 converged; 1 not converged or no solution; 2 bad input; 3 internal error; 4 stopped by a
/// signal with a checkpoint to go on from. Initialises and finalises MPI and Kokkos. Errors are printed once,
/// by rank 0, on the standard error stream.
int main(int argc, char** argv, const Application& application);

} // namespace Harmos::app
