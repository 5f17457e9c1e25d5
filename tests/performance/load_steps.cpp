// SPDX-License-Identifier: BSD-3-Clause

/// A hundred load steps of the Signorini model by feti::FetiSolver: what a step costs beside the first
/// solution, and beside one that starts cold. Writes JSON; see README.md.

#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Tpetra_Core.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>

using namespace Harmos;

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Pressure that rises, falls and wanders over the membranes; step k of a period of a hundred. A step changes
// it by up to 0.038 · change.
std::vector<std::shared_ptr<const std::vector<double>>> loads(const TestModel& model, int k, double change) {
  constexpr double turn = 2.0 * 3.14159265358979323846 / 100.0;
  std::vector<std::shared_ptr<const std::vector<double>>> result;
  for (const feti::Subdomain& subdomain : model.subdomains) {
    auto load = std::make_shared<std::vector<double>>(*subdomain.load);
    const double wave = std::cos(turn * k + 0.5 * static_cast<double>(subdomain.number % 7));
    const double factor = 1.0 + change * (0.4 * std::sin(turn * k) + 0.2 * wave);
    for (double& value : *load)
      value *= factor;
    result.push_back(load);
  }
  return result;
}

} // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = testComm();
  CLI::App app("Load steps of the Signorini model");
  int subdomains = 8, elements = 16, steps = 100;
  double tolerance = 1e-4, change = 1.0;
  std::string output;
  app.add_option("--subdomains", subdomains, "S: subdomains a side");
  app.add_option("--elements", elements, "N: elements a subdomain side");
  app.add_option("--steps", steps);
  app.add_option("--change", change, "of the loads: 1 for up to 3.8 per cent a step");
  app.add_option("--tolerance", tolerance, "of the solver");
  app.add_option("--output", output, "JSON file");
  CLI11_PARSE(app, argc, argv);

  const TestModel model = testModel(subdomains, elements);
  Teuchos::ParameterList parameters;
  parameters.sublist("Solver").set("Tolerance", tolerance);
  comm->barrier();
  double start = now();
  feti::FetiSolver solver(comm, model.subdomains, model.rows, parameters);
  solver.setLoads(loads(model, 0, change));
  bool converged = solver.solve().converged;
  const double first = globalMax(*comm, now() - start);
  const feti::FactorizationCounts before = solver.factorizations();
  struct Sum {
    double seconds = 0.0;
    int products = 0, others = 0;
  } warm, cold;
  const auto step = [&](int k, Sum& sum) {
    const auto values = loads(model, k, change);
    comm->barrier();
    start = now();
    solver.setLoads(values);
    const feti::SolveReport& report = solver.solve();
    sum.seconds += globalMax(*comm, now() - start);
    sum.products += report.result.counters.hessianApplications;
    sum.others += report.result.counters.setupApplications;
    converged = converged && report.converged;
  };
  for (int k = 1; k <= steps; ++k)
    step(k, warm);
  for (int k = 1; k <= steps; ++k) {
    solver.forgetSolutions();
    step(k, cold);
  }
  const feti::FactorizationCounts after = solver.factorizations();
  const nlohmann::json document = {{"benchmark", "load_steps"},
                                   {"harmos", {{"version", version()}, {"git", gitHash()}}},
                                   {"ranks", comm->getSize()},
                                   {"runs",
                                    {{{"subdomains_per_side", subdomains},
                                      {"elements_per_subdomain_side", elements},
                                      {"steps", steps},
                                      {"tolerance", tolerance},
                                      {"change", change},
                                      {"converged", converged},
                                      {"factorizations", before.factorizations},
                                      {"later_factorizations", after.factorizations - before.factorizations},
                                      {"first_seconds", first},
                                      {"step_seconds", warm.seconds / steps},
                                      {"cold_step_seconds", cold.seconds / steps},
                                      {"step_products", static_cast<double>(warm.products) / steps},
                                      {"cold_step_products", static_cast<double>(cold.products) / steps},
                                      {"step_setup_products", static_cast<double>(warm.others) / steps}}}}};
  if (comm->getRank() == 0) {
    std::cout << document["runs"][0].dump(2) << std::endl;
    if (!output.empty())
      std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
