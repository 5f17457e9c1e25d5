// SPDX-License-Identifier: BSD-3-Clause

/// The journal bearing problem of MINPACK-2 (Averick, Carter, Moré, Xue 1992):
///
///     min ∫ ½ w_q|∇v|² − w_l v over (0, 2π) × (0, 2b),   v ≥ 0,   v = 0 on the boundary,
///     w_q = (1 + ε cos ξ₁)³,   w_l = ε sin ξ₁,   b = 10,   ε = 0.1,
///
/// on n × n interior points, to ‖g^P‖ ≤ 1e-6‖b‖; writes JSON, see README.md.

#include "Harmos_GridProblem.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
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

struct Settings {
  std::string method = "Auto";
  std::string preconditioner = "multigrid on face";
  bool nested = true;
  double tolerance = 1e-6;
  double coarseTolerance = 1e-3;
  double innerReduction = 0.1;
  double faceTolerance = 0.01;
};

// A level of the nested iteration: from the coarser one's solution, or from zero.
nlohmann::json solveLevel(const GridProblem& grid, const Teuchos::RCP<MultiVector>& x, double tolerance,
                          const Settings& settings) {
  const double start = now();
  const auto problem = Teuchos::rcp(new qp::TpetraProblem(grid.matrix, x, grid.rhs));
  problem->setLowerBound(Teuchos::rcp(new MultiVector(grid.map, 1)));
  Teuchos::RCP<MultigridOnFace> onFace;
  if (settings.preconditioner == "multigrid") {
    problem->setPreconditioner(multigrid(grid.matrix));
  } else if (settings.preconditioner == "multigrid on face") {
    onFace = Teuchos::rcp(new MultigridOnFace(grid.matrix, settings.faceTolerance));
    problem->setFacePreconditioner(onFace);
  }
  const double setup = now() - start;
  problem->setProblem();
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", tolerance);
  list->set("Maximum Iterations", 100000);
  if (settings.method == "Auto" || settings.method == "PDAS")
    list->sublist("Expert").sublist("PDAS").set("Inner reduction", settings.innerReduction);
  const auto solver = qp::TpetraSolverFactory().create(settings.method, list);
  solver->setProblem(problem);
  const qp::Result result = solver->solve();
  const qp::Counters& c = result.counters;
  return {{"n", grid.n},
          {"reason", qp::toString(result.reason)},
          {"method", result.method},
          {"hessian_applications", c.hessianApplications},
          {"setup_applications", c.setupApplications},
          {"cg_steps", c.cgSteps},
          {"active_set_updates", c.activeSetUpdates},
          {"expansion_steps", c.expansionSteps},
          {"proportioning_steps", c.proportioningSteps},
          {"preconditioner_applications", c.preconditionerApplications},
          {"preconditioner_setups", c.preconditionerSetups},
          {"safeguards", c.safeguards},
          {"relative_projected_gradient", result.projectedGradientNorm / grid.rhs->getVector(0)->norm2()},
          {"seconds_setup", setup + (onFace.is_null() ? 0.0 : onFace->seconds())},
          {"seconds", now() - start}};
}

} // namespace

int main(int argc, char** argv) {
  Tpetra::ScopeGuard guard(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  CLI::App app("Journal bearing problem");
  std::vector<int> sizes = {128, 256, 512};
  int repetitions = 3;
  std::string output;
  Settings settings;
  app.add_option("--sizes", sizes, "interior points a side")->delimiter(',');
  app.add_option("--repetitions", repetitions);
  app.add_option("--method", settings.method);
  app.add_option("--preconditioner", settings.preconditioner, "none, multigrid, multigrid on face");
  app.add_option("--nested", settings.nested, "start each size from coarser grids; their cost counts");
  app.add_option("--coarse-tolerance", settings.coarseTolerance);
  app.add_option("--inner-reduction", settings.innerReduction);
  app.add_option("--face-tolerance", settings.faceTolerance,
                 "part of the entries that may change sides before multigrid is made anew");
  app.add_option("--output", output, "a JSON file");
  CLI11_PARSE(app, argc, argv);

  constexpr double halfWidth = 10.0, eccentricity = 0.1;
  const double pi = std::acos(-1.0);
  nlohmann::json runs = nlohmann::json::array();
  for (const int n : sizes)
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      std::vector<int> levels = {n};
      while (settings.nested && levels.front() >= 64)
        levels.insert(levels.begin(), levels.front() / 2);
      // The matrices are the user's; assembling them is no part of solving.
      std::vector<GridProblem> grids;
      for (const int m : levels)
        grids.push_back(gridProblem(
            comm, m, 2.0 * pi, 2.0 * halfWidth,
            [&](double x) { return std::pow(1.0 + eccentricity * std::cos(x), 3); },
            [&](double x, double) { return eccentricity * std::sin(x); }));
      comm->barrier();
      const double start = now();
      nlohmann::json history = nlohmann::json::array();
      Teuchos::RCP<MultiVector> x;
      double products = 0.0;
      for (std::size_t k = 0; k < grids.size(); ++k) {
        const auto next = Teuchos::rcp(new MultiVector(grids[k].map, 1));
        if (k > 0)
          interpolate(grids[k - 1], *x, grids[k], *next);
        x = next;
        const bool finest = k + 1 == grids.size();
        history.push_back(
            solveLevel(grids[k], x, finest ? settings.tolerance : settings.coarseTolerance, settings));
        // In units of a product on the finest grid.
        const double ratio = static_cast<double>(levels[k]) / n;
        products += history.back()["hessian_applications"].get<double>() * ratio * ratio;
      }
      const double seconds = now() - start;
      runs.push_back(
          {{"n", n}, {"seconds", seconds}, {"fine_equivalent_applications", products}, {"levels", history}});
      if (comm->getRank() == 0) {
        const auto& last = history.back();
        std::cout << "n " << n << "  " << last["method"].get<std::string>() << ", "
                  << last["reason"].get<std::string>() << ": " << last["hessian_applications"]
                  << " products, " << last["cg_steps"] << " cg, " << last["active_set_updates"] << " sets, "
                  << last["preconditioner_applications"] << " V-cycles, " << products << " in all, "
                  << last["seconds_setup"] << " s setup, " << last["seconds"] << " s, " << seconds
                  << " s in all\n";
      }
    }
  if (comm->getRank() == 0 && !output.empty()) {
    const nlohmann::json document = {
        {"benchmark", "journal_bearing"}, {"harmos", {{"version", version()}, {"git", gitHash()}}},
        {"ranks", comm->getSize()},       {"preconditioner", settings.preconditioner},
        {"nested", settings.nested},      {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
