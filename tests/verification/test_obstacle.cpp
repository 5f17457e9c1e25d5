// SPDX-License-Identifier: BSD-3-Clause

/// A membrane pressed onto a plane: Δu = 1 where u > 0, u ≥ 0, on the square (−1, 1)², solved by the QP layer
/// on Tpetra matrices. The exact solution is radial about the centre,
///
///     u = (r² − r₀²)/4 − (r₀²/2) ln(r/r₀) outside of the contact disc r ≤ r₀, 0 inside,
///
/// and gives the boundary values. Energy J(v) = ½∫|∇v|² + ∫v.

#include "Harmos_Exchange.hpp"
#include "Harmos_GridProblem.hpp"
#include "Harmos_TestComm.hpp"

#include "Harmos_FittedRate.hpp"
#include <Tpetra_CrsMatrix.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

using namespace Harmos;
using namespace Harmos::qp;

namespace {

constexpr double contactRadius = 0.6;
constexpr double pi = 3.14159265358979323846;

double exact(double x, double y) { // coordinates of the grid, (0, 2)²
  const double r2 = (x - 1.0) * (x - 1.0) + (y - 1.0) * (y - 1.0), c2 = contactRadius * contactRadius;
  return r2 <= c2 ? 0.0 : (r2 - c2) / 4.0 - c2 / 4.0 * std::log(r2 / c2);
}

// J(u) = ½∮u ∂u/∂n + ½∫u by Green's formula with Δu = 1; both as smooth integrals over the angle, by
// Simpson's rule, the radial one in closed form.
double exactEnergy() {
  const double c = contactRadius, c2 = c * c;
  constexpr int intervals = 2000;
  double boundary = 0.0, area = 0.0;
  for (int k = 0; k <= intervals; ++k) {
    const double weight = (k == 0 || k == intervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) / 3.0 / intervals;
    const double t = static_cast<double>(k) / intervals, r2 = 1.0 + t * t; // the point (1, t) of an eighth
    const double u = (r2 - c2) / 4.0 - c2 / 4.0 * std::log(r2 / c2);
    const double slope = 0.5 - c2 / (2.0 * r2); // ∂u/∂x at x = 1: u_r x/r, u_r = r/2 − c²/(2r)
    boundary += weight * u * slope;
    const double angle = pi / 4.0 * t, edge = 1.0 / std::cos(angle), e2 = edge * edge;
    // ∫ u r dr from c to e, by parts: r⁴/16 − c²r²/8 − (c²/2)(r²/2 ln(r/c) − r²/4).
    const auto antiderivative = [&](double s2) {
      return s2 * s2 / 16.0 - c2 * s2 / 8.0 - c2 / 2.0 * (s2 / 4.0 * std::log(s2 / c2) - s2 / 4.0);
    };
    area += weight * pi / 4.0 * (antiderivative(e2) - antiderivative(c2));
  }
  return 0.5 * 8.0 * boundary + 0.5 * 8.0 * area;
}

struct Solution {
  GridProblem grid;
  Teuchos::RCP<MultiVector> u;
  Result result;
};

GridProblem membrane(int n) {
  return gridProblem(
      testComm(), n, 2.0, 2.0, [](double) { return 1.0; }, [](double, double) { return -1.0; }, exact);
}

using Precondition = std::function<void(TpetraProblem&, const GridProblem&)>;

// On each mesh from the solution of the one before.
std::vector<Solution> solveAll(const std::string& method, const std::vector<int>& sizes,
                               const Precondition& precondition) {
  std::vector<Solution> solutions;
  for (int n : sizes) {
    Solution solution{membrane(n), Teuchos::null, {}};
    solution.u = Teuchos::rcp(new MultiVector(solution.grid.map, 1));
    if (!solutions.empty())
      interpolate(solutions.back().grid, *solutions.back().u, solution.grid, *solution.u);
    const auto problem = Teuchos::rcp(new TpetraProblem(solution.grid.matrix, solution.u, solution.grid.rhs));
    problem->setLowerBound(Teuchos::rcp(new MultiVector(solution.grid.map, 1)));
    precondition(*problem, solution.grid);
    EXPECT_TRUE(problem->setProblem());
    const auto list = Teuchos::parameterList();
    list->set("Convergence Tolerance", 1e-8);
    const auto solver = TpetraSolverFactory().create(method, list);
    solver->setProblem(problem);
    solution.result = solver->solve();
    EXPECT_TRUE(solution.result.converged()) << solution.result.explanation;
    solutions.push_back(solution);
  }
  return solutions;
}

// Of all but the first solution, which had nothing to start from.
std::vector<int> counts(const std::vector<Solution>& solutions) {
  std::vector<int> result;
  for (std::size_t k = 1; k < solutions.size(); ++k)
    result.push_back(solutions[k].result.counters.hessianApplications);
  return result;
}

std::string text(const std::vector<int>& counts) {
  std::string result;
  for (int count : counts)
    result += " " + std::to_string(count);
  return result;
}

// J of the piecewise linear function with the exact boundary values, loads by the vertex rule: the energy of
// the interior values, −½xᵀb where it is stationary, would leave the boundary's part out.
double energy(const Solution& solution) {
  const GridProblem& grid = solution.grid;
  const double h = grid.hx();
  // Values of the whole grid on every rank.
  std::vector<double> all(static_cast<std::size_t>(grid.n + 2) * static_cast<std::size_t>(grid.n + 2), 0.0);
  const auto at = [&](int i, int j) -> double& {
    return all[static_cast<std::size_t>(j) * static_cast<std::size_t>(grid.n + 2) +
               static_cast<std::size_t>(i)];
  };
  const auto view = solution.u->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t l = 0; l < view.extent(0); ++l) {
    const auto index = grid.map->getGlobalElement(static_cast<LocalOrdinal>(l));
    at(static_cast<int>(index % grid.n) + 1, static_cast<int>(index / grid.n) + 1) = view(l, 0);
  }
  globalSum(*testComm(), all);
  for (int k = 0; k < grid.n + 2; ++k) {
    at(k, 0) = exact(k * h, 0.0);
    at(k, grid.n + 1) = exact(k * h, 2.0);
    at(0, k) = exact(0.0, k * h);
    at(grid.n + 1, k) = exact(2.0, k * h);
  }
  double sum = 0.0;
  for (int j = 0; j <= grid.n; ++j)
    for (int i = 0; i <= grid.n; ++i) {
      const double a = at(i, j), b = at(i + 1, j), c = at(i, j + 1), d = at(i + 1, j + 1);
      // Each edge belongs to two cells; the outer ones to one, with half the weight in the triangles as well.
      sum += 0.25 * ((b - a) * (b - a) + (d - c) * (d - c) + (c - a) * (c - a) + (d - b) * (d - b));
      sum += h * h * 0.25 * (a + b + c + d);
    }
  return sum;
}

// Largest distance of the discrete free boundary from the circle: contact outside of it, or none inside.
double freeBoundaryError(const Solution& solution) {
  const GridProblem& grid = solution.grid;
  const auto view = solution.u->getLocalViewHost(Tpetra::Access::ReadOnly);
  double error = 0.0;
  for (std::size_t l = 0; l < view.extent(0); ++l) {
    const auto index = grid.map->getGlobalElement(static_cast<LocalOrdinal>(l));
    const double x = static_cast<double>(index % grid.n + 1) * grid.hx() - 1.0;
    const double y = static_cast<double>(index / grid.n + 1) * grid.hy() - 1.0;
    const double outside = std::hypot(x, y) - contactRadius;
    if (view(l, 0) == 0.0 ? outside > 0.0 : outside < 0.0)
      error = std::max(error, std::abs(outside));
  }
  return globalMax(*testComm(), error);
}

const std::vector<int> sizes = {31, 63, 127, 255};

} // namespace

TEST(Obstacle, energy_and_free_boundary_converge) {
  const std::vector<Solution> solutions =
      solveAll("Auto", sizes, [](TpetraProblem& problem, const GridProblem& grid) {
        problem.setFacePreconditioner(Teuchos::rcp(new MultigridOnFace(grid.matrix, 0.01)));
      });
  const double expected = exactEnergy();
  std::vector<double> h, energyErrors, boundaryErrors, nodalErrors;
  for (const Solution& solution : solutions) {
    EXPECT_EQ(solution.result.method, "PDAS");
    h.push_back(solution.grid.hx());
    energyErrors.push_back(std::abs(energy(solution) - expected));
    boundaryErrors.push_back(freeBoundaryError(solution));
    MultiVector difference(*solution.u, Teuchos::Copy);
    difference.update(-1.0, *gridFunction(solution.grid, exact), 1.0);
    nodalErrors.push_back(difference.getVector(0)->normInf());
    if (testComm()->getRank() == 0)
      std::cout << "h " << h.back() << "  energy error " << energyErrors.back() << "  free boundary "
                << boundaryErrors.back() << "  largest nodal error " << nodalErrors.back() << "\n";
  }
  // Energies of linear elements converge like h² (Falk 1974 for the norm, whose square it is); values at
  // nodes like h² up to a logarithm (Nitsche 1977); the free boundary like h where the load does not
  // degenerate (Brezzi & Caffarelli 1983), in jumps of the grid.
  EXPECT_NEAR(fittedRate(h, energyErrors), 2.0, 0.2);
  EXPECT_NEAR(fittedRate(h, nodalErrors), 2.0, 0.3);
  EXPECT_NEAR(fittedRate(h, boundaryErrors), 1.0, 0.35);
  for (std::size_t k = 0; k < h.size(); ++k)
    EXPECT_LE(boundaryErrors[k], 2.0 * h[k]);
}

// MPRGP, its iteration counts over four meshes: flat with multigrid made for the face, growing without.
TEST(Obstacle, counts_with_a_preconditioner_in_face_stay_flat) {
  const auto run = [&](const char* what, const Precondition& precondition) {
    const std::vector<int> result = counts(solveAll("MPRGP", {15, 31, 63, 127, 255}, precondition));
    if (testComm()->getRank() == 0)
      std::cout << "products with A, " << what << ":" << text(result) << "\n";
    return result;
  };
  const std::vector<int> onFace =
      run("multigrid on the face", [](TpetraProblem& problem, const GridProblem& grid) {
        problem.setFacePreconditioner(Teuchos::rcp(new MultigridOnFace(grid.matrix, 0.0)));
      });
  const std::vector<int> approximate =
      run("multigrid of the whole matrix", [](TpetraProblem& problem, const GridProblem& grid) {
        problem.setPreconditioner(multigrid(grid.matrix));
      });
  const std::vector<int> factors =
      run("incomplete factors", [](TpetraProblem& problem, const GridProblem& grid) {
        problem.setPreconditioner(incompleteFactor(grid.matrix, 4));
      });
  const std::vector<int> none = run("none", [](TpetraProblem&, const GridProblem&) {});
  EXPECT_LE(2 * *std::max_element(onFace.begin(), onFace.end()),
            3 * *std::min_element(onFace.begin(), onFace.end()));
  EXPECT_LT(approximate.back(), none.back());
  EXPECT_LT(factors.back(), none.back());
  EXPECT_GT(none.back(), 3 * none.front()); // without: like 1/h
}
