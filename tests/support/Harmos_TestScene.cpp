// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestScene.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_TestComm.hpp"

#include <filesystem>
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

void addInterface(scene::Scene& scene, scene::Interface::Kind kind, const Part& first, const Part& second,
                  double gap) {
  scene::Interface interface;
  interface.kind = kind;
  interface.firstBody = first.body;
  interface.firstSet = first.set;
  interface.secondBody = second.body;
  interface.secondSet = second.set;
  interface.gap = gap;
  scene.interfaces.push_back(interface);
}

scene::Body& bodyOf(scene::Scene& scene, int body) {
  return scene.bodies.at(static_cast<std::size_t>(body));
}

} // namespace

void addContact(scene::Scene& scene, const Part& first, const Part& second, double gap) {
  addInterface(scene, scene::Interface::Kind::Contact, first, second, gap);
}

void addTie(scene::Scene& scene, const Part& first, const Part& second) {
  addInterface(scene, scene::Interface::Kind::Tie, first, second, 0.0);
}

void addObstacle(scene::Scene& scene, const Part& part, const contact::Obstacle& obstacle) {
  scene.obstacles.push_back({"obstacle", part.body, part.set, obstacle});
}

void prescribe(scene::Scene& scene, const Part& part, int component, double value) {
  bodyOf(scene, part.body).prescribed.push_back({part.set, value, component});
}

void addTraction(scene::Scene& scene, const Part& part, const fem::Point& density) {
  bodyOf(scene, part.body).tractions.push_back({part.set, [density](const fem::Point&, const fem::Point&) {
                                                  return density;
                                                }});
}

void addForce(scene::Scene& scene, int body, const fem::Point& density) {
  bodyOf(scene, body).forces.push_back([density](const fem::Point&) { return density; });
}

void addTemperature(scene::Scene& scene, int body, double rise) {
  bodyOf(scene, body).temperature += rise;
}

TestRun runScene(const scene::Scene& scene, double tolerance, const std::vector<std::string>& assignments,
                 const Teuchos::RCP<const Teuchos::Comm<int>>& comm) {
  ParameterSpec deck("deck", "A deck.");
  scene::RunOptions::addTo(deck);
  Teuchos::ParameterList list = deck.defaults();
  for (const std::string& assignment : assignments) {
    const std::size_t sign = assignment.find('=');
    deck.set(list, assignment.substr(0, sign), assignment.substr(sign + 1), "test");
  }
  scene::RunOptions options = scene::RunOptions::fromDeck(deck.validated(list, "test"));
  options.tolerance = tolerance;
  options.writeFields = false;
  options.progressFrequency = 0;
  // Of this program and its number of ranks alone: tests may run side by side.
  options.outputDirectory =
      (std::filesystem::temp_directory_path() /
       ("harmos_" + std::filesystem::read_symlink("/proc/self/exe").filename().string() + "_np" +
        std::to_string(testComm()->getSize()) +
        (comm.is_null() ? "" : "_rank" + std::to_string(testComm()->getRank()))))
          .string();
  TestRun run;
  run.solution = scene::run(comm.is_null() ? testComm() : comm, scene, options, Log(),
                            std::chrono::steady_clock::now(), run.report);
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
