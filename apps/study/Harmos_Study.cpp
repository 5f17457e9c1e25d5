// SPDX-License-Identifier: BSD-3-Clause

/// What accuracy costs in time: a scene over axes of settings, errors against a finer reference.

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_StudyCharts.hpp"
#include "Harmos_StudyErrors.hpp"
#include "Harmos_StudyResult.hpp"
#include "Harmos_StudyTable.hpp"
#include "Harmos_Version.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace {

using namespace Harmos;
using namespace Harmos::study;

const std::vector<std::string> stages = {"mesh",   "assembly", "factorization", "dual_operator",
                                         "coarse", "solve",    "recovery"};

std::vector<std::string> columnsOf(const Plan& plan) {
  std::vector<std::string> columns;
  for (const Axis& axis : plan.axes)
    columns.push_back(axis.name);
  for (const char* name : {"ranks", "git", "study", "converged", "reason", "repetitions", "seconds"})
    columns.push_back(name);
  for (const std::string& stage : stages)
    columns.push_back("seconds_" + stage);
  for (const char* name :
       {"products", "iterations", "outer_iterations", "primal_dimension", "dual_dimension", "subdomains",
        "dual_operator", "solver", "memory_mib", "tight_tolerance", "solver_judged", "estimated_error"})
    columns.push_back(name);
  for (std::size_t k = 0; k < measuresOf(plan); ++k)
    for (const char* part :
         {"error", "discretisation", "solver", "local", "reference", "judged", "discretisation_judged"})
      columns.push_back(measureNames[k] + "_" + part);
  return columns;
}

std::string yes(bool value) {
  return value ? "yes" : "no";
}

Row rowOf(const Plan& plan, const Setting& setting, const Outcome& outcome, const ErrorParts& parts,
          const Errors& reference) {
  Row row;
  for (const std::string& column : columnsOf(plan))
    row[column] = "";
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    row[plan.axes[a].name] = plan.axes[a].text(setting[a]);
  const run::RunReport& report = outcome.report;
  const qp::Counters& counters = report.result.counters;
  row["ranks"] = std::to_string(report.ranks);
  row["git"] = gitHash();
  row["study"] = plan.fingerprint;
  row["converged"] = yes(outcome.run && report.converged);
  row["reason"] = outcome.reason;
  row["repetitions"] = std::to_string(outcome.repetitions);
  row["tight_tolerance"] = textOf(parts.tightTolerance);
  // A tight run is the measure of runs that are ten times less tight.
  row["solver_judged"] = yes(outcome.run && report.tolerance > 9.99 * parts.tightTolerance);
  if (outcome.run) {
    row["seconds"] = textOf(outcome.seconds.at("total"));
    for (const std::string& stage : stages)
      row["seconds_" + stage] = textOf(outcome.seconds.at(stage));
    row["products"] = std::to_string(counters.hessianApplications);
    row["iterations"] =
        std::to_string(counters.cgSteps + counters.expansionSteps + counters.proportioningSteps);
    row["outer_iterations"] = std::to_string(counters.outerIterations);
    row["primal_dimension"] = std::to_string(report.primalDimension);
    row["dual_dimension"] = std::to_string(report.dualDimension);
    row["subdomains"] = std::to_string(report.subdomains);
    row["dual_operator"] = report.dualOperator;
    row["solver"] = report.solver;
    row["memory_mib"] = textOf(outcome.memoryMiB);
    if (const auto estimate = report.results.find("estimated_error"); estimate != report.results.end())
      row["estimated_error"] = textOf(estimate->second);
  }
  for (std::size_t k = 0; k < measuresOf(plan); ++k) {
    const std::string& name = measureNames[k];
    const auto judged = [&](double error) { return yes(error >= 10.0 * reference[k]); };
    row[name + "_error"] = textOf(parts.total[k]);
    row[name + "_discretisation"] = textOf(parts.discretisation[k]);
    row[name + "_solver"] = textOf(parts.solver[k]);
    row[name + "_local"] = textOf(parts.local[k]);
    row[name + "_reference"] = textOf(reference[k]);
    row[name + "_judged"] = judged(parts.total[k]);
    row[name + "_discretisation_judged"] = judged(parts.discretisation[k]);
  }
  return row;
}

// "12 s", "3 min".
std::string duration(double seconds) {
  return seconds < 100.0 ? std::to_string(std::lround(seconds)) + " s"
                         : std::to_string(std::lround(seconds / 60.0)) + " min";
}

// Which settings have no row yet: rank 0 alone holds the table.
std::vector<Setting> missing(const Teuchos::Comm<int>& comm, const Plan& plan, const Table* table,
                             const std::vector<Setting>& all) {
  std::vector<int> mine;
  if (table != nullptr)
    for (std::size_t k = 0; k < all.size(); ++k)
      if (table->find(plan, all[k], comm.getSize()) == nullptr)
        mine.push_back(static_cast<int>(k));
  std::vector<Setting> result;
  for (int k : gatherAll(comm, mine))
    result.push_back(all[static_cast<std::size_t>(k)]);
  return result;
}

std::string told(const Plan& plan, const Row& row) {
  const bool ran = !row.at("seconds").empty() && row.at("converged") == "yes";
  if (!ran)
    return "no solution: " + row.at("reason");
  std::string text = scientific(numberOf(row, "seconds"), 1) + " s";
  for (std::size_t k = 0; k < measuresOf(plan); ++k)
    if (std::isfinite(numberOf(row, measureNames[k] + "_error")))
      text += (k == 0 ? "; errors: " : ", ") + measureTitles[k] + " " +
              scientific(numberOf(row, measureNames[k] + "_error"), 1) +
              (row.at(measureNames[k] + "_judged") == "yes" ? "" : " (not judged)");
  return text;
}

// Writes what the study has found. @return the exit status.
int conclude(const Teuchos::Comm<int>& comm, const Plan& plan, const Table* table, const Log& log) {
  bool anyConverged = false, drawn = false;
  agree(comm, [&] {
    if (!table)
      return;
    const Result result(plan, *table, comm.getSize());
    io::writeAtomically(plan.output + "/study.json", toJson(plan, *table, result, comm.getSize()));
    for (const std::string& sentence : result.sentences)
      log.info(sentence);
    anyConverged = std::any_of(result.points.begin(), result.points.end(),
                               [](const Point& point) { return point.converged; });
    drawn = plan.charts && drawCharts(plan.output, log);
  });
  log.info("Results in \"" + plan.output + "\": study.csv, study.json" +
           (drawn ? ", charts as PNG and SVG" : ""));
  if (globalMax(comm, anyConverged ? 1LL : 0LL) == 0) {
    log.error("no run of the study converged; see the reasons in the table");
    return 1;
  }
  return 0;
}

int runStudy(const app::ProgramContext& context) {
  const auto& comm = context.comm; // C++17's lambdas capture no structured bindings
  const app::CommandLine& line = context.line;
  const Log& log = context.log;
  const Plan plan(*comm, line);
  for (const std::string& note : plan.notes)
    log.info("Note: " + note);
  const std::vector<Setting> all = plan.settings();
  if (line.check) {
    log.info("The deck \"" + line.deck + "\" is valid: " + std::to_string(all.size()) + " settings of \"" +
             plan.deck + "\".");
    return 0;
  }
  std::unique_ptr<Table> table;
  agree(*comm, [&] {
    if (comm->getRank() != 0)
      return;
    io::makeDirectory(plan.output);
    table = std::make_unique<Table>(plan, columnsOf(plan));
  });
  const std::vector<Setting> todo = missing(*comm, plan, table.get(), all);
  log.info(std::to_string(all.size()) + " settings, " + std::to_string(plan.repetitions) +
           " or more repetitions each; " + std::to_string(all.size() - todo.size()) +
           " already in the table and not repeated");
  ErrorJudge judge(comm, plan, log);
  if (!todo.empty())
    judge.referenceErrors(); // here, so that it does not count for the time that is left
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < todo.size(); ++k) {
    std::vector<std::string> assignments = plan.sceneAssignments(todo[k]);
    const std::vector<std::string> more = plan.solverAssignments(todo[k]);
    assignments.insert(assignments.end(), more.begin(), more.end());
    const Errors reference = judge.referenceErrors();
    Outcome outcome = runSetting(comm, plan, assignments, Repetition::Planned);
    outcome.report.ranks = comm->getSize();
    ErrorParts parts = ErrorJudge::unknown();
    try {
      parts = judge.partsOf(todo[k], outcome);
    } catch (const NumericalError& error) { // on all ranks: a tight run has no solution
      outcome.reason += std::string("; errors unknown: ") + error.what();
    }
    const Row row = rowOf(plan, todo[k], outcome, parts, reference);
    agree(*comm, [&] {
      if (table)
        table->add(row);
    });
    const std::chrono::duration<double> past = std::chrono::steady_clock::now() - start;
    const auto done = static_cast<double>(k + 1), left = static_cast<double>(todo.size() - k - 1);
    log.info(std::to_string(k + 1) + "/" + std::to_string(todo.size()) + " " + plan.label(todo[k]) + ": " +
             told(plan, row) + (left > 0 ? "; " + duration(past.count() / done * left) + " left" : ""));
  }
  return conclude(*comm, plan, table.get(), log);
}

} // namespace

int main(int argc, char** argv) {
  app::Program program;
  program.name = "study";
  program.description = "what accuracy costs in time: a scene over axes of settings";
  program.deckSpec = Plan::deckSpec;
  program.run = runStudy;
  return app::main(argc, argv, program);
}
