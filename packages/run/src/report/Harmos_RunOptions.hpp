// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualOptions.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_SolverOptions.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::run {

using feti::ToleranceRule;
struct Quantity;

/// What a run was told from outside.
enum class Told {
  Nothing,
  Save, ///< to write a checkpoint
  Stop  ///< to write one and stop
};

/// When a run writes a checkpoint, and the checkpoint that it restarts from. The checkpoint contains all data
/// that a restart needs.
struct CheckpointOptions {
  int outerIterations = 0; ///< between two checkpoints; 0 for none
  double minutes = 30.0;   ///< likewise
  int steps = 1;           ///< likewise, of a run with several steps
  /// What this rank was told since it was last asked; null: nothing. Local.
  std::function<Told()> told;
  std::string restart;                   ///< the output directory of the run to go on from; "" for none
  std::string deck;                      ///< the validated deck, as XML
  std::string deckFile;                  ///< where it was read
  std::vector<std::string> assignments;  ///< that were applied to it
  std::map<std::string, int> subdomains; ///< that were chosen, by body; see Scene::chosenSubdomains
  std::vector<std::string> mayDiffer;    ///< lists of an application's own that may be others after a restart
};

/// Fields of cells in the result file, besides subdomain, body and region.
struct CellFields {
  bool stress = false; ///< mean stresses of elastic bodies, see run::cellStresses()
  bool error = false;  ///< estimated errors, see run::estimateDiscretisationError()
};

/// The lists of a deck that every application shares: Decomposition, Dual operator, Solver, Output.
struct RunOptions : feti::SolverOptions {
  std::optional<feti::DirichletForm> dirichlet = feti::DirichletForm::Primal; ///< nothing: as the scene asks
  feti::DualOptions dual;
  std::string outputDirectory;
  bool writeFields = true;
  bool writeStresses = true;
  CellFields cellFields;
  int every = 1;            ///< of several steps, the first of those whose fields are written
  bool writeRanks = false;  ///< ranks.csv
  double liveSeconds = 5.0; ///< between two contact.csv; 0 for none
  /// Whose value and adjoint are wanted of the last answer, see Solution::quantity; null: of none.
  std::shared_ptr<const Quantity> quantity = nullptr;
  CheckpointOptions checkpoint;

  /// Adds the lists to the specification of a deck.
  static void addTo(ParameterSpec& deck, bool mayBeTransient = false);
  /// From a validated deck.
  static RunOptions fromDeck(const Teuchos::ParameterList& deck);
};

/// How prescribed displacements are enforced: as the options say, else dual (Total FETI) where a body comes
/// from a mesh, and there is one material: where it jumps by 1e12, Total FETI takes ten times the products.
/// Of subdomains without structure some are held by a few nodes only, and are soft in a way that no rigid
/// motion in the coarse space mends: products differ by half from cut to cut.
feti::DirichletForm dirichletForm(const scene::Scene& scene, const RunOptions& options);

/// The options of the solver, with what the scene decides: the first active set is also tried with the one of
/// the nearest point where a body comes from a mesh.
feti::SolverOptions solverOptions(const scene::Scene& scene, const RunOptions& options);

/// Refuses options that contradict each other or the scene, before anything is computed.
/// @throws InputError
void checkConsistency(const scene::Scene& scene, const RunOptions& options);

} // namespace Harmos::run
