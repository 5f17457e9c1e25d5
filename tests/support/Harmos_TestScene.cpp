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

TestRun runScene(const scene::Scene& scene, double tolerance, const std::vector<std::string>& assignments) {
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
        std::to_string(testComm()->getSize())))
          .string();
  TestRun run;
  run.solution = scene::run(testComm(), scene, options, Log(), std::chrono::steady_clock::now(), run.report);
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
