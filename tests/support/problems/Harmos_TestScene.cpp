// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestScene.hpp"

#include "Harmos_BodyForce.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_PrescribedDisplacement.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_ThermalStrain.hpp"
#include "Harmos_Tie.hpp"
#include "Harmos_Traction.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <unistd.h>

namespace Harmos {

scene::Body blockBody(const std::string& name, fem::StructuredBlock::Options& options,
                      const fem::Material& material) {
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  options.firstNode += block->numberOfNodes();
  scene::Body body;
  body.name = name;
  body.subdomains = block->numberOfSubdomains();
  body.subdomain = [block](int k) { return block->subdomain(k); };
  body.materials = {material};
  return body;
}

namespace {

effects::SurfacePair pairOf(const Part& first, const Part& second) {
  effects::SurfacePair pair;
  pair.first = {first.body, first.set};
  pair.second = {second.body, second.set};
  return pair;
}

template<class Effect, class... Arguments>
void add(scene::Scene& scene, Arguments&&... arguments) {
  scene.effects.push_back(std::make_shared<Effect>(std::forward<Arguments>(arguments)...));
}

} // namespace

void addContact(scene::Scene& scene, const Part& first, const Part& second, double gap, double reach) {
  effects::SurfacePair pair = pairOf(first, second);
  pair.reach = reach;
  add<effects::Contact>(scene, pair, gap);
}

void addTie(scene::Scene& scene, const Part& first, const Part& second) {
  add<effects::Tie>(scene, pairOf(first, second));
}

void addObstacle(scene::Scene& scene, const Part& part, const contact::Obstacle& obstacle) {
  add<effects::RigidObstacle>(scene, effects::Part{part.body, part.set}, obstacle);
}

void prescribe(scene::Scene& scene, const Part& part, int component, double value) {
  scene.effects.push_back(effects::hold({part.body, part.set}, component, value));
}

void prescribe(scene::Scene& scene, const Part& part, int component,
               const std::function<double(const fem::Point&)>& field) {
  using effects::PrescribedDisplacement;
  add<PrescribedDisplacement>(scene, effects::Part{part.body, part.set},
                              std::vector<PrescribedDisplacement::Component>{{component, 0.0, field}});
}

void addTraction(scene::Scene& scene, const Part& part, const fem::Point& density) {
  addTraction(scene, part, [density](const fem::Point&, const fem::Point&) { return density; });
}

void addTraction(scene::Scene& scene, const Part& part, const fem::Traction& density) {
  add<effects::Traction>(scene, effects::Part{part.body, part.set}, density);
}

void addForce(scene::Scene& scene, int body, const fem::Point& density) {
  add<effects::BodyForce>(scene, body, density);
}

void addForce(scene::Scene& scene, int body, const fem::VectorField& density) {
  add<effects::BodyForce>(scene, body, density);
}

void addForce(scene::Scene& scene, int body, const std::vector<fem::BoxLoad>& loads) {
  add<effects::BodyForce>(scene, body, loads);
}

void addTemperature(scene::Scene& scene, int body, double rise) {
  add<effects::ThermalStrain>(scene, body, rise);
}

void removeEffects(scene::Scene& scene, const std::string& kind) {
  scene.effects.erase(std::remove_if(scene.effects.begin(), scene.effects.end(),
                                     [&](const auto& effect) { return effect->kind() == kind; }),
                      scene.effects.end());
}

run::RunOptions testOptions(double tolerance, const std::vector<std::string>& assignments) {
  ParameterSpec deck("deck", "A deck.");
  run::RunOptions::addTo(deck);
  Teuchos::ParameterList list = deck.defaults();
  for (const std::string& assignment : assignments) {
    const std::size_t sign = assignment.find('=');
    deck.set(list, assignment.substr(0, sign), assignment.substr(sign + 1), "test");
  }
  run::RunOptions options = run::RunOptions::fromDeck(deck.validated(list, "test"));
  options.tolerance = tolerance;
  options.writeFields = false;
  options.progressFrequency = 0;
  // Of this program and its number of ranks alone: tests may run side by side.
  options.outputDirectory =
      (std::filesystem::temp_directory_path() /
       ("harmos_" + std::filesystem::read_symlink("/proc/self/exe").filename().string() + "_np" +
        std::to_string(testComm()->getSize())))
          .string();
  return options;
}

TestRun runScene(const scene::Scene& scene, double tolerance, const std::vector<std::string>& assignments,
                 const Teuchos::RCP<const Teuchos::Comm<int>>& comm) {
  run::RunOptions options = testOptions(tolerance, assignments);
  if (!comm.is_null())
    options.outputDirectory += "_rank" + std::to_string(testComm()->getRank());
  TestRun run;
  const bool isTold = std::getenv("HARMOS_TEST_LOG") != nullptr;
  const Log log =
      isTold ? Log(std::cout, std::cerr, Log::Verbosity::Detailed, testComm()->getRank() == 0) : Log();
  const Teuchos::RCP<const Teuchos::Comm<int>> ranks = comm.is_null() ? testComm() : comm;
  run.solution = run::runScene(ranks, scene, options, log, std::chrono::steady_clock::now(), run.report);
  run::WholeContact contact = run::gatherContact(*ranks, run.report.contactPoints, run.report.contact);
  run.report.contactPoints = std::move(contact.points);
  run.report.contact = std::move(contact.states);
  return run;
}

std::string failureOf(const scene::Scene& scene) {
  try {
    runScene(scene, 1e-6);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

} // namespace Harmos
