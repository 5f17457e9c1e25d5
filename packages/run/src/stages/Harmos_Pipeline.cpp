// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Pipeline.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_PartsFile.hpp"
#include "Harmos_ProcessMemory.hpp"
#include "Harmos_RankTable.hpp"
#include "Harmos_RunStages.hpp"
#include "Harmos_StageTimers.hpp"
#include "Harmos_StepSequence.hpp"
#include "Harmos_TimedLoads.hpp"

namespace Harmos::run {
namespace {

std::string valueOf(const Error& error, const std::string& name) {
  for (const auto& [key, value] : error.data())
    if (key == name)
      return value;
  return "";
}

// feti knows subdomains only; whoever reads the message knows bodies. Parts of bodies hang together by sides
// and their kernels follow from what is prescribed: what seems a mechanism there is a stiffness that is lost
// in rounding errors.
NumericalError withBody(const scene::Scene& scene, const NumericalError& error) {
  if (valueOf(error, "subdomain").empty())
    return error;
  long long number = std::stoll(valueOf(error, "subdomain"));
  for (const scene::Body& body : scene.bodies) {
    if (number < body.subdomains) {
      ErrorData data = error.data();
      data.emplace_back("body", body.name);
      const std::string what = "body \"" + body.name + "\": " + error.what();
      if (valueOf(error, "may be rounding").empty())
        return NumericalError(what, std::move(data));
      return NumericalError(
          "attainable accuracy: the matrix of a subdomain does not separate its softest modes from "
          "rigid-body modes in double precision, so no digit of them is reliable. Use less thin cells, "
          "smaller material jumps or a Poisson's ratio further from 0.5; " +
              what,
          std::move(data));
    }
    number -= body.subdomains;
  }
  return error;
}

} // namespace

Solution runScene(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                  const RunOptions& options, const Log& log, std::chrono::steady_clock::time_point begin,
                  RunReport& report) {
  const std::vector<std::string>& stages = RunStages::names();
  const StageTimers timers(stages);
  RankShare share;
  std::exception_ptr failure;
  Solution solution;
  try {
    const RunContext context{comm, scene, options, log, timers, report, share};
    RunStages run(context);
    solution = scene.goesInSteps() ? StepSequence(context, run).go() : run.goOnce();
  } catch (const NumericalError& error) {
    failure = std::make_exception_ptr(withBody(scene, error));
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::Internal && !error.isAgreed())
      throw; // of this rank alone: nothing collective may follow
    failure = std::current_exception();
  }
  const std::vector<double> seconds = timers.seconds(*comm);
  for (std::size_t k = 0; k < stages.size(); ++k)
    report.seconds[stages[k]] = seconds[k];
  report.seconds["mesh"] += globalMax(*comm, scene.secondsToMake);
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - begin;
  report.seconds["total"] = globalMax(*comm, total.count());
  share.peakMemoryMiB = peakMemoryMiB();
  report.peakMemoryMiB = globalSum(*comm, share.peakMemoryMiB);
  if (options.writeRanks) {
    share.seconds = timers.ownSeconds();
    try {
      writeRankTable(*comm, options.outputDirectory + "/ranks.csv", stages, share);
    } catch (const InputError&) {
      if (!failure) // the first failure is the one that matters
        throw;
    }
  }
  if (failure)
    std::rethrow_exception(failure);
  log.info(timingText(report, stages));
  return solution;
}

void checkScene(const Teuchos::Comm<int>& comm, const scene::Scene& scene) {
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(comm, scene);
  scene::checkBoundaryParts(comm, scene, owned);
  agree(comm, [&] {
    if (scene.goesInSteps()) {
      scene::EffectCosts costs(scene);
      scene::TimedLoads(scene, owned, costs).requireConsistent();
    }
    scene::assemble(scene, owned);
  });
  scene::setUpContact(comm, scene, owned);
}

void showParts(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const std::string& directory,
               const Log& log) {
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(comm, scene);
  const std::vector<scene::PartSummary> parts = scene::boundaryPartsOf(comm, scene, owned);
  log.info(partsText(scene, parts));
  if (directory.empty())
    return;
  agree(comm, [&] {
    if (comm.getRank() == 0)
      io::makeDirectory(directory);
  });
  writeParts(comm, directory + "/parts.vtkhdf", scene, owned, parts);
  log.info("Written: \"" + directory + "/parts.vtkhdf\"; plot with harmos-plot " + directory + " --parts");
}

void writeSummaryAlone(const RunOptions& options, const RunReport& report) {
  io::makeDirectory(options.outputDirectory);
  io::writeAtomically(options.outputDirectory + "/summary.json", toJson(report));
}

void writeSummary(const Teuchos::Comm<int>& comm, const RunOptions& options, const RunReport& report) {
  agree(comm, [&] {
    if (comm.getRank() == 0)
      writeSummaryAlone(options, report);
  });
}

} // namespace Harmos::run
