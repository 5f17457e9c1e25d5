// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeProgram.hpp"

#include "Harmos_HarmosApplication.hpp"
#include "Harmos_Pipeline.hpp"
#include "Harmos_RolOptions.hpp"
#include "Harmos_ShapeRun.hpp"
#include "Harmos_Signals.hpp"

#include <Teuchos_XMLParameterListHelpers.hpp>

#include <filesystem>
#include <sstream>

namespace Harmos::shape {
namespace {

constexpr int exitConverged = 0, exitNotConverged = 1, exitInterrupted = 4;

app::Application application() {
  app::Application application = app::harmosApplication(app::KinematicsChoice::Small);
  application.name = "shape";
  application.description = "the best shape of a contact surface";
  application.addParameters = [scene = application.addParameters](ParameterSpec& deck) {
    scene(deck);
    ShapeDeck::addTo(deck);
  };
  return application;
}

run::RunOptions optionsOf(const app::ProgramContext& context, const Teuchos::ParameterList& deck) {
  run::RunOptions options = run::RunOptions::fromDeck(deck);
  if (!context.line.output.empty())
    options.outputDirectory = context.line.output;
  std::ostringstream text;
  Teuchos::writeParameterListToXmlOStream(deck, text);
  options.checkpoint.deck = text.str();
  options.checkpoint.deckFile = std::filesystem::absolute(context.line.deck).string();
  options.checkpoint.assignments = context.line.assignments;
  options.checkpoint.restart = context.line.restart;
  options.checkpoint.told = app::Signals::told;
  options.checkpoint.mayDiffer = {"Shape/Limits"};
  return options;
}

void check(const app::ProgramContext& context, const scene::Scene& scene,
           const Teuchos::ParameterList& deck) {
  ShapeDeck::fromDeck(deck, scene);
  run::checkScene(*context.comm, scene);
  context.log.info("The deck \"" + context.line.deck + "\" is valid.");
}

int work(const app::ProgramContext& context) {
  const auto& [comm, line, log, begin] = context;
  const app::Application application = shape::application();
  const Teuchos::ParameterList deck = app::readDeck(context, app::deckSpec(application));
  const run::RunOptions options = optionsOf(context, deck);
  const scene::Scene scene = app::sceneOf(application, {*comm, deck, app::directoryOf(line.deck), log});
  if (line.parts) {
    run::showParts(*comm, scene, line.output, log);
    return exitConverged;
  }
  run::checkConsistency(scene, options);
  if (options.toleranceRule != run::ToleranceRule::Fixed)
    throw InputError(
        "\"Solver/Tolerance rule\" = \"balanced\" would change the tolerance with the design; use \"fixed\"",
        {{"path", "Solver/Tolerance rule"}});
  // Before anything is solved; volumes are linear in all designs.
  rol::completeOptions(deck.sublist("Shape").sublist("Optimiser"), false);
  if (line.check) {
    check(context, scene, deck);
    return exitConverged;
  }
  run::RunReport report;
  report.deck = line.deck;
  try {
    ShapeRun(comm, scene, deck, options, log, begin, report).go();
  } catch (const Error& error) {
    app::leaveSummary(context, options, report, error);
    throw;
  } catch (const std::exception& error) { // of a library, or no memory is left
    app::leaveSummary(context, options, report, InternalError(error.what()));
    throw;
  }
  for (const auto& [name, value] : report.results)
    log.info(name + ": " + scientific(value, 6));
  run::writeSummary(*comm, options, report);
  log.info("Results in \"" + options.outputDirectory + "\"; plot with harmos-plot " +
           options.outputDirectory + " --shape");
  if (report.isInterrupted() && report.checkpointFault.empty()) {
    log.warning(report.reason);
    return exitInterrupted;
  }
  if (!report.converged)
    log.error("the optimiser did not converge: " + report.reason);
  return report.converged ? exitConverged : exitNotConverged;
}

} // namespace

app::Program shapeProgram() {
  const app::Application application = shape::application();
  app::Program program;
  program.name = application.name;
  program.description = application.description;
  program.deckSpec = [application] { return app::deckSpec(application); };
  program.effects = application.effects;
  program.restarts = true;
  program.showsParts = true;
  program.run = work;
  return program;
}

} // namespace Harmos::shape
