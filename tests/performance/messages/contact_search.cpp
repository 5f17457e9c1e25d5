// SPDX-License-Identifier: BSD-3-Clause

/// What it takes to find the points of contact of two bodies whose meshes do not match, at a fixed surface a
/// rank: memory and time of the rank that needs most. Writes JSON; see README.md.

#include "Harmos_Contact.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_DefaultComm.hpp>
#include <Tpetra_Core.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>

using namespace Harmos;

namespace {

// Of this process, at its peak.
double peakMiB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0)
      return std::stod(line.substr(6)) / 1024.0;
  return 0.0;
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// A slab of so many subdomains of unit size, one element thick, that meets the other one at z = 0.
// Or both bent about a ball.
scene::Body slab(const std::string& name, const std::array<int, 3>& subdomains, int elements, bool isUpper,
                 long long firstNode, bool isBent) {
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Hexahedron8;
  options.origin = {0.0, 0.0, isUpper ? 0.0 : -1.0};
  options.size = {static_cast<double>(subdomains[0]), static_cast<double>(subdomains[1]), 1.0};
  options.subdomains = subdomains;
  options.elements = {elements, elements, 1};
  options.firstNode = firstNode;
  if (isBent) {
    const double radius = std::max(options.size[0], options.size[1]);
    const fem::Point middle = {0.5 * options.size[0], 0.5 * options.size[1], 0.0};
    options.map = [radius, middle](const fem::Point& x) {
      const double u = (x[0] - middle[0]) / radius, v = (x[1] - middle[1]) / radius;
      const double length = std::sqrt(1.0 + u * u + v * v), r = radius + x[2];
      return fem::Point{r * u / length, r * v / length, r / length};
    };
  }
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  scene::Body body;
  body.name = name;
  body.subdomains = block->numberOfSubdomains();
  body.subdomain = [block](int k) { return block->subdomain(k); };
  body.materials = {fem::Material::isotropic(1.0, 0.3)};
  return body;
}

// Half of the ranks have one body, half the other: what touches is on two ranks at least.
scene::Scene sceneOf(int ranks, int side, int elements, bool isBent) {
  int columns = 1;
  while (2 * columns * columns < ranks)
    columns *= 2;
  const int rows = std::max(1, ranks / 2 / columns);
  scene::Scene scene;
  scene.name = "slabs";
  scene.physics = scene::Physics::Solid;
  constexpr long long ofSecond = 1LL << 40;
  scene.bodies.push_back(slab("lower", {side * columns, side * rows, 1}, elements, false, 0, isBent));
  scene.bodies.push_back(
      slab("upper", {side * columns, side * rows, 1}, elements + 1, true, ofSecond, isBent));
  effects::SurfacePair pair;
  pair.first = {0, "top"};
  pair.second = {1, "bottom"};
  scene.effects.push_back(std::make_shared<effects::Contact>(pair, 0.0, "joint"));
  return scene;
}

} // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Teuchos::DefaultComm<int>::getComm();
  CLI::App app("The search for contact, at a fixed surface a rank");
  int side = 2, elements = 32;
  bool isBent = false;
  std::string output;
  app.add_flag("--bent", isBent, "about a ball, so that normals lie across the axes");
  app.add_option("--side", side, "subdomains a side of a rank's share of a body");
  app.add_option("--elements", elements, "a subdomain side");
  app.add_option("--output", output, "JSON file");
  CLI11_PARSE(app, argc, argv);

  const scene::Scene scene = sceneOf(comm->getSize(), side, elements, isBent);
  const auto owned = scene::decompose(*comm, scene);
  comm->barrier();
  const double before = peakMiB(), start = now();
  const scene::ContactSetup setup = scene::setUpContact(*comm, scene, owned);
  const double seconds = globalMax(*comm, now() - start);
  nlohmann::json run;
  long long facets = 0;
  for (const scene::OwnedSubdomain& item : owned)
    if (const auto sides = item.mesh.sides.find(item.body == 0 ? "top" : "bottom");
        sides != item.mesh.sides.end())
      facets += static_cast<long long>(sides->second.size());
  run["facets"] = globalSum(*comm, facets);
  run["facets_of_rank"] = globalMax(*comm, facets);
  run["points_of_rank"] = globalMax(*comm, static_cast<long long>(setup.points.size()));
  run["rows"] = globalSum(*comm, static_cast<long long>(setup.rows.size()));
  run["memory_mib_of_rank"] = globalMax(*comm, peakMiB() - before);
  run["seconds"] = seconds;
  nlohmann::json document = {{"benchmark", "contact_search"},
                             {"harmos", {{"version", version()}, {"git", gitHash()}}},
                             {"ranks", comm->getSize()},
                             {"runs", nlohmann::json::array({run})}};
  if (comm->getRank() == 0) {
    std::cout << document.dump(2) << '\n';
    if (!output.empty())
      std::ofstream(output) << document.dump(2) << '\n';
  }
  return 0;
}
