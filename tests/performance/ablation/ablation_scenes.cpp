// SPDX-License-Identifier: BSD-3-Clause

/// Random scenes with each constant of the QP layer that they ask for changed, one at a time: what
/// ablation.py runs. Built from the sources as they are there is nothing to change, and it measures the
/// scenes alone.
///
///     ablation_scenes --random 0:200 --friction 0:100 --trials trials.json --output lines.json
///
/// A line of JSON a run: family, scene, knob, value, converged, applications, energy.

#include "Harmos_Errors.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_RandomScene.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_Tuning.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Core.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

using namespace Harmos;

// This program is none of GoogleTest's, whose main() has it else.
Teuchos::RCP<const Teuchos::Comm<int>> Harmos::testComm() {
  return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
}

namespace {

struct Range {
  unsigned begin = 0, end = 0;
};

Range rangeOf(const std::string& text) {
  if (text.empty())
    return {};
  const std::size_t colon = text.find(':');
  return {static_cast<unsigned>(std::stoul(text.substr(0, colon))),
          static_cast<unsigned>(std::stoul(text.substr(colon + 1)))};
}

nlohmann::json runOf(const RandomScene& random) {
  nlohmann::json line;
  try {
    const TestRun run = runScene(random.scene, random.tolerance, random.settings);
    line["converged"] = run.report.converged;
    line["applications"] = run.report.result.counters.hessianApplications;
    if (std::isfinite(run.report.audit.energy))
      line["energy"] = run.report.audit.energy;
    line["reason"] = run.report.converged ? "" : run.report.reason.substr(0, 60);
  } catch (const std::exception& error) {
    line = {{"converged", false}, {"applications", 0}, {"reason", std::string(error.what()).substr(0, 60)}};
  }
  return line;
}

// Contacts are drawn, and so is what rubs.
bool hasFriction(const scene::Scene& scene) {
  return std::any_of(scene.effects.begin(), scene.effects.end(),
                     [](const auto& effect) { return effect->kind() == effects::Friction::kindName; });
}

// @param trials values of each knob.
void tryScene(const std::string& family, const RandomScene& random, const nlohmann::json& trials,
              std::ofstream& output) {
  std::map<std::string, tuning::Knob>& knobs = tuning::Knobs::all().map();
  const auto tell = [&](nlohmann::json line, const std::string& knob, double value) {
    line["family"] = family;
    line["scene"] = random.seed;
    line["solvable"] = random.isSolvable;
    if (!knob.empty()) {
      line["knob"] = knob;
      line["value"] = value;
    }
    output << line.dump() << std::endl;
  };
  for (auto& item : knobs)
    item.second.isAsked = false;
  tell(runOf(random), "", 0.0);
  std::vector<std::string> asked;
  for (const auto& [name, knob] : knobs)
    if (knob.isAsked && trials.contains(name))
      asked.push_back(name);
  for (const std::string& name : asked)
    for (const double value : trials[name]) {
      knobs.at(name).value = value;
      tell(runOf(random), name, value);
      knobs.at(name).value = knobs.at(name).standard;
    }
}

} // namespace

int main(int argc, char* argv[]) {
  const Tpetra::ScopeGuard scope(&argc, &argv);
  CLI::App program("Random scenes with constants of the QP layer changed");
  std::string random, friction, trialFile, outputFile;
  program.add_option("--random", random, "seeds, FIRST:END");
  program.add_option("--friction", friction, "seeds of scenes with friction");
  program.add_option("--trials", trialFile, "JSON: values of each knob");
  program.add_option("--output", outputFile, "lines of JSON")->required();
  CLI11_PARSE(program, argc, argv);
  nlohmann::json trials = nlohmann::json::object();
  if (!trialFile.empty())
    std::ifstream(trialFile) >> trials;
  std::ofstream output(outputFile, std::ios::app);
  for (unsigned seed = rangeOf(random).begin; seed < rangeOf(random).end; ++seed)
    tryScene("random", randomScene(seed), trials, output);
  for (unsigned seed = rangeOf(friction).begin; seed < rangeOf(friction).end; ++seed)
    if (const RandomScene scene = randomFrictionScene(seed, 1.0); hasFriction(scene.scene))
      tryScene("friction", scene, trials, output);
  return output.good() ? 0 : 1;
}
