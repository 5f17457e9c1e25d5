// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DesignModel.hpp"
#include "Harmos_DesignRecord.hpp"
#include "Harmos_GapProfile.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Minimise.hpp"
#include "Harmos_RunDirectory.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"
#include "Harmos_ShapeDeck.hpp"
#include "Harmos_ShapeModel.hpp"
#include "Harmos_ShapeResults.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace Harmos::shape {

/// An optimisation from a deck to its files: set-up as a run has it, designs by ROL, and what they leave
/// behind.
///
/// Whatever ends it, the best design so far is on disk, and with --restart the run goes on from all that was
/// computed.
///
/// Guarded by tests/regression/shape/test_shape.py.
class ShapeRun {
 public:
  /// All to outlive this. @param deck validated. @param report filled as far as the run gets.
  ShapeRun(Teuchos::RCP<const Teuchos::Comm<int>> comm, const scene::Scene& scene,
           const Teuchos::ParameterList& deck, const run::RunOptions& options, const Log& log,
           std::chrono::steady_clock::time_point begin, run::RunReport& report);

  /// @throws InputError, NumericalError, InternalError on all ranks. @note Collective.
  void go();

 private:
  void setUp();
  void makeModel();
  void makeFunctional();
  void solveFirst();
  void restore();
  void optimise();
  rol::Outcome minimised();
  rol::Outcome minimisedFrom(const std::vector<double>& start, std::vector<double>* closed);
  std::vector<double> reclosed(const std::vector<double>& design);
  void finish();
  void conclude(const rol::Outcome& outcome);

  void askBefore();
  void accepted(const rol::Iterate& iterate);
  void exchange(qp::StateArchive<MultiVector>& archive);
  void save();
  void writeHistory() const;
  void writeDesign() const;
  SurfaceState state() const;
  Answer answer() const;
  sensitivity::DesignProblem problem();
  feti::TornVector meanDisplacement() const;
  sensitivity::ShapeMap shapeMap() const;
  double elapsed() const;

  Teuchos::RCP<const Teuchos::Comm<int>> comm_;
  const scene::Scene& scene_;
  const Teuchos::ParameterList& deckList_;
  ShapeDeck deck_;
  const run::RunOptions& options_;
  const Log& log_;
  std::chrono::steady_clock::time_point begin_;
  run::RunReport& report_;
  run::RunDirectory directory_;

  std::vector<scene::OwnedSubdomain> owned_;
  scene::ContactSetup contact_;
  std::unique_ptr<feti::FetiSolver> solver_;
  std::unique_ptr<sensitivity::DesignModel> model_;
  // One of these two is it.
  const sensitivity::ShapeModel* moved_ = nullptr;
  const sensitivity::GapProfile* profile_ = nullptr;
  std::vector<fem::Point> places_; // of the numbers of a design, where they have any
  std::unique_ptr<sensitivity::Functional> functional_;
  std::unique_ptr<sensitivity::ContactCost> cost_;
  std::unique_ptr<sensitivity::DesignVolume> volume_;
  std::unique_ptr<DesignRecord> record_;
  sensitivity::DesignSpace space_;

  SurfaceState before_;
  std::vector<HistoryRow> history_;
  std::vector<double> best_;
  std::size_t bestRow_ = 0; // of the history
  double costBefore_ = 0.0, lastSave_ = 0.0;
  double firstValueSeconds_ = 0.0, setUpSeconds_ = 0.0, outputSeconds_ = 0.0;
};

} // namespace Harmos::shape
