// SPDX-License-Identifier: BSD-3-Clause
/// (h) The obstacle below an application's own torn matrices, shaped by ROL such that the peak of the contact
/// pressure is small.
#include "torn_membrane.hpp"

#include <Harmos_DesignModel.hpp>
#include <Harmos_GapProfile.hpp>
#include <Harmos_Minimise.hpp>
#include <Tpetra_Core.hpp>

#include <cmath>
#include <cstdio>

using namespace Harmos;

int main(int argc, char** argv) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  const TornMembrane membrane;
  const std::vector<ConstraintRow> rows = membrane.obstacle(*comm, 0.2);
  Teuchos::ParameterList parameters;
  parameters.sublist("Solver").set("Tolerance", 1e-10);
  feti::FetiSolver solver(comm, membrane.subdomains(*comm, 1.0, -1.0), rows, parameters);

  // Of each row that this rank gave: its area, normal and place, and the surface that it belongs to.
  sensitivity::RowGeometry geometry;
  for (const ConstraintRow& row : rows) {
    const bool isEnd = row.number == 0 || row.number == membrane.s * membrane.n;
    geometry.areas.push_back(isEnd ? 0.5 * membrane.size() : membrane.size());
    geometry.normals.push_back({0.0, 0.0, -1.0});
    geometry.positions.push_back({1.0, membrane.size() * static_cast<double>(row.number), 0.0});
    geometry.surfaces.push_back(0);
  }

  // What the design adds to the gaps: quadratic splines along y on eight pieces.
  const sensitivity::TensorSplineBasis basis({sensitivity::SplineBasis::uniform(2, 0.0, 1.0, 8)}, {1});
  sensitivity::GapProfile profile(solver, rows, geometry, {0}, basis);
  const sensitivity::PressureNorm peak({0}, 8.0);
  sensitivity::ContactCost cost(solver, profile, peak);
  sensitivity::DesignVolume volume(profile);

  sensitivity::DesignProblem problem;
  const std::size_t n = profile.size();
  problem.space = {std::vector<double>(n, 0.0), std::vector<double>(n, -0.2), std::vector<double>(n, 0.2),
                   profile.weights()};
  problem.cost = &cost;
  problem.constraints = {{"volume", &volume, 0.0, 0.0, profile.hasLinearVolume()}};

  const auto tell = [&](const char* when, const std::vector<double>& design) {
    cost.value(design, 0.0);
    const auto pressure = sensitivity::pressureSummary(*comm, cost.forces(), geometry, {0});
    if (comm->getRank() == 0)
      std::printf("%s: peak pressure %.3f, mean %.3f\n", when, pressure.peak, pressure.mean);
  };
  tell("before", problem.space.start);
  const int before = solver.factorizations().factorizations;
  const rol::Outcome outcome = rol::minimise(problem);
  if (comm->getRank() == 0)
    std::printf("%s: %s\n", outcome.isConverged() ? "converged" : "not converged", outcome.reason.c_str());
  tell("after", outcome.design);
  if (comm->getRank() == 0)
    std::printf("%s than 100 evaluations, volume kept: %s, new factorisations: %d\n",
                outcome.values < 100 ? "less" : "more",
                std::abs(outcome.constraints[0]) < 1e-9 ? "yes" : "no",
                solver.factorizations().factorizations - before);
}
