// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyRun.hpp"

#include "Harmos_AdaptiveRounds.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <malloc.h>

namespace Harmos::study {
namespace {

// Of /proc/self/status, in MiB; 0 where there is none.
double statusMiB(const std::string& key) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == key + ":") {
      double kib = 0.0;
      status >> kib;
      return kib / 1024.0;
    }
  return 0.0;
}

// What is resident before a run, the peak set back to it.
double residentMiB() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  std::ofstream("/proc/self/clear_refs") << "5";
  return statusMiB("VmRSS");
}

// The part of the deck by which solves with subdomains are inexact.
std::vector<std::string> inexactLocalSolver(const Teuchos::ParameterList& dual) {
  const std::string precision = dual.get<std::string>("Precision");
  const double lowRank = dual.sublist("Expert").get<double>("Block low rank tolerance");
  if (precision != "single" && lowRank == 0.0)
    return {}; // auto stays far below what the solver leaves
  return {"Dual operator/Form=" + dual.get<std::string>("Form"), "Dual operator/Precision=" + precision,
          "Dual operator/Expert/Block low rank tolerance=" + scientific(lowRank, 6)};
}

} // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

namespace {

// A run, with the rounds of its meshes. Seconds are those of all of them.
struct Repeated {
  std::map<std::string, double> seconds;
  run::FinishedRun run;
  std::shared_ptr<const fem::SizeField> sizes;
};
Repeated runOnce(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Plan& plan,
                 const Teuchos::ParameterList& deck, std::shared_ptr<const fem::SizeField> sizes,
                 run::RunReport& report) {
  const Log silent;
  run::RunOptions options = run::RunOptions::fromDeck(deck);
  options.outputDirectory = plan.output + "/last_run";
  options.writeFields = false;
  options.progressFrequency = 0;
  app::AdaptiveRounds rounds(comm, deck);
  const bool adapts = rounds.isAsked() && sizes == nullptr;
  rounds.setOptions(options);
  Repeated result;
  while (true) {
    rounds.begin();
    const auto begin = std::chrono::steady_clock::now();
    if (adapts)
      sizes = rounds.sizes();
    scene::Scene scene =
        app::sceneOf(plan.application, {*comm, deck, app::directoryOf(plan.deck), silent, {}, sizes});
    const std::chrono::duration<double> making = std::chrono::steady_clock::now() - begin;
    scene.secondsToMake = making.count();
    run::checkConsistency(scene, options);
    rounds.check(scene, options);
    report = {};
    report.deck = plan.deck;
    run::Solution solution = run::runScene(comm, scene, options, silent, begin, report);
    report.seconds["total"] -= report.seconds["output"];
    for (const auto& [stage, value] : report.seconds)
      result.seconds[stage] += value;
    if (adapts && report.converged)
      rounds.judge(scene, solution, report);
    if (!adapts || rounds.isOver() || !report.converged) {
      run::WholeContact contact = run::gatherContact(*comm, report.contactPoints, report.contact);
      result.run = {std::move(scene), std::move(solution), std::move(contact.points),
                    std::move(contact.states)};
      result.sizes = std::move(sizes);
      return result;
    }
  }
}

} // namespace

Outcome runSetting(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Plan& plan,
                   const std::vector<std::string>& assignments, Repetition repetition,
                   const std::shared_ptr<const fem::SizeField>& sizes) {
  const bool isOnce = repetition == Repetition::Once;
  const int least = isOnce ? 1 : plan.repetitions, most = isOnce ? 1 : 100;
  Outcome outcome;
  std::map<std::string, std::vector<double>> seconds;
  double sum = 0.0; // the same on all ranks, as seconds of reports are
  for (int run = 0; run < least || (run < most && sum < plan.leastSeconds); ++run) {
    run::RunReport report;
    report.deck = plan.deck;
    Repeated once;
    try {
      const Teuchos::ParameterList deck = plan.readDeck(*comm, assignments);
      const double resident = residentMiB();
      comm->barrier(); // so that no rank's time holds another one's waiting
      once = runOnce(comm, plan, deck, sizes, report);
      if (run == 0) {
        outcome.memoryMiB = globalSum(*comm, statusMiB("VmHWM") - resident);
        outcome.run = std::make_shared<run::FinishedRun>(std::move(once.run));
        outcome.sizes = once.sizes;
        outcome.reason = report.reason;
        outcome.report = report;
        outcome.localSolver = inexactLocalSolver(deck.sublist("Dual operator"));
      }
    } catch (const Error& error) {
      if (app::standsAlone(*comm, error))
        throw;
      outcome.report = report;
      outcome.report.converged = false;
      outcome.reason = error.what();
      outcome.run = nullptr;
      return outcome;
    }
    for (const auto& [stage, value] : once.seconds)
      seconds[stage].push_back(value);
    sum += once.seconds["total"];
    ++outcome.repetitions;
    if (!report.converged)
      break; // its time is not asked for
  }
  for (const auto& [stage, values] : seconds)
    outcome.seconds[stage] = median(values);
  return outcome;
}

} // namespace Harmos::study
