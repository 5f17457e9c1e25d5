// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AdaptiveSpace.hpp"
#include "Harmos_DeflatedOperators.hpp"
#include "Harmos_DominantModes.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_JumpEnergy.hpp"
#include "Harmos_TestFeti.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace test_adaptive_space {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

constexpr double stiff = 1e6;

// The two membranes of n × n elements a subdomain, with stiff threads through each subdomain from one cut to
// the next, two of them: what one end of a thread does, the other does too, at no cost.
TestModel threaded(int s, int n, bool tied = false) {
  TestModel model = testModel(s, n, tied);
  for (Subdomain& subdomain : model.subdomains) {
    const LocalMatrix& old = *subdomain.stiffness;
    std::map<std::pair<int, int>, double> entries;
    for (int r = 0; r < old.rows(); ++r)
      for (std::size_t k = old.offsets[static_cast<std::size_t>(r)];
           k < old.offsets[static_cast<std::size_t>(r) + 1]; ++k)
        entries[{r, old.columns[k]}] = old.values[k];
    const auto tie = [&](int i, int j) {
      entries[{i, i}] += stiff;
      entries[{j, j}] += stiff;
      entries[{i, j}] -= stiff;
      entries[{j, i}] -= stiff;
    };
    for (int row : {1, n - 1})
      tie(row * (n + 1), row * (n + 1) + n);
    auto matrix = std::make_shared<LocalMatrix>();
    for (int r = 0; r < old.rows(); ++r) {
      for (auto e = entries.lower_bound({r, 0}); e != entries.end() && e->first.first == r; ++e) {
        matrix->columns.push_back(e->first.second);
        matrix->values.push_back(e->second);
      }
      matrix->offsets.push_back(matrix->columns.size());
    }
    subdomain.stiffness = matrix;
  }
  return model;
}

struct Space {
  Space(const TestModel& model, double threshold)
      : feti(model, DirichletForm::Primal, withSchur()),
        preconditioner(Teuchos::rcp(new DualPreconditioner(feti.system, feti.constraints, feti.inverses,
                                                           PreconditionerKind::Dirichlet,
                                                           PreconditionerScaling::Stiffness))),
        space({feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dualOperator, preconditioner},
              {withSchur(), PreconditionerKind::Dirichlet, PreconditionerScaling::Stiffness},
              {AdaptiveVectors::All, threshold}) {
    space.make(Log());
  }

  static LocalInverseOptions withSchur() {
    LocalInverseOptions options;
    options.keepSchur = true;
    return options;
  }
  double isEquality(int row) const {
    return feti.constraints.rowType(row) == RowType::Inequality ? 0.0 : 1.0;
  }

  TestFeti feti;
  Teuchos::RCP<const DualPreconditioner> preconditioner;
  AdaptiveSpace space;
};

MultiVector wave(const Teuchos::RCP<const Map>& map, double step) {
  MultiVector x(map, 1);
  const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) =
        std::sin(1.0 + step * static_cast<double>(map->getGlobalElement(static_cast<LocalOrdinal>(r))));
  return x;
}

double dot(const MultiVector& x, const MultiVector& y) {
  std::vector<double> result(1);
  x.dot(y, Teuchos::arrayViewFromVector(result));
  return result[0];
}

double norm(const MultiVector& x) {
  return std::sqrt(dot(x, x));
}

} // namespace

// N_s of each subdomain against (MB_sv, B_sv), both by the operators.
TEST(AdaptiveSpace, energy_of_a_jump_is_that_of_the_preconditioner) {
  const Space setup(threaded(3, 4), 10.0);
  const Constraints& constraints = setup.feti.constraints;
  MultiVector mask(constraints.rowMap(), 1);
  {
    const auto view = mask.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) = setup.isEquality(static_cast<int>(r));
  }
  const std::vector<CongruenceClass>& classes = setup.feti.inverses.classes();
  const std::vector<std::vector<double>> energies =
      jumpEnergies(classes, setup.feti.dualOperator, *setup.preconditioner, mask);
  for (long long number = 0; number < setup.feti.system.globalSubdomains(); ++number) {
    std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
    double expected = 0.0;
    for (const CongruenceClass& item : classes)
      for (int i : item.members)
        if (setup.feti.system.subdomain(i).number == number) {
          const std::size_t n = item.boundary.size();
          std::vector<double> u(static_cast<std::size_t>(setup.feti.system.matrix(i).rows()), 0.0);
          for (int dof : item.boundary)
            u[static_cast<std::size_t>(dof)] = std::cos(0.7 * dof);
          constraints.addB(i, u.data(), overlap.data());
          for (std::size_t p = 0; p < n; ++p)
            for (std::size_t q = 0; q < n; ++q)
              expected += energies[static_cast<std::size_t>(i)][p * n + q] *
                          u[static_cast<std::size_t>(item.boundary[p])] *
                          u[static_cast<std::size_t>(item.boundary[q])];
        }
    expected = globalSum(*testComm(), expected);
    MultiVector jump(constraints.rowMap(), 1), image(constraints.rowMap(), 1);
    constraints.fromOverlap(overlap, jump);
    {
      const auto is = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
      const auto view = jump.getLocalViewHost(Tpetra::Access::ReadWrite);
      for (std::size_t r = 0; r < view.extent(0); ++r)
        view(r, 0) *= is(r, 0);
    }
    setup.preconditioner->apply(jump, image);
    // Sums of some hundred terms of stiff entries.
    EXPECT_NEAR(dot(image, jump), expected, 1e-11 * stiff) << number;
  }
}

// Of diagonal matrices they are known; the kernel is left out, whatever its energy.
TEST(AdaptiveSpace, dominant_modes_of_a_known_pencil) {
  const int n = 120;
  std::vector<double> energy(n * n, 0.0), inverse(n * n, 0.0), kernel(n, 0.0);
  const auto mu = [](int k) { return k < 5 ? 1e6 / (1 + k * k) : k < 12 ? 200.0 + k : 9.0 / k; };
  for (int k = 0; k < n; ++k) {
    const double s = 1.0 + k % 7;
    energy[static_cast<std::size_t>(k * n + k)] = k == n - 1 ? 1e9 : mu(k) * s;
    inverse[static_cast<std::size_t>(k * n + k)] = k == n - 1 ? 1.0 : 1.0 / s;
  }
  kernel[n - 1] = 1.0;
  const feti::DenseOperator op(inverse, n, Precision::Double, 1);
  const DominantModes modes = dominantModes(energy, op, kernel, 1, 10.0, 200, 1);
  ASSERT_EQ(modes.values.size(), 12u);
  for (int k = 0; k < 12; ++k) {
    const double expected = k < 5 ? mu(k) : 200.0 + 16 - k; // falling
    EXPECT_NEAR(modes.values[static_cast<std::size_t>(k)], expected, 1e-6 * expected) << k;
  }
  EXPECT_EQ(dominantModes(energy, op, kernel, 1, 10.0, 3, 1).values.size(), 3u);
  EXPECT_TRUE(dominantModes(energy, op, kernel, 1, 2e6, 200, 1).values.empty());
}

// F'U = 0 where U has no entries at bounds and GU = 0; what is eliminated comes back by complete().
TEST(AdaptiveSpace, elimination_leaves_residuals_as_they_are) {
  const Space setup(threaded(4, 4), 10.0);
  const Deflation* deflation = setup.space.deflation();
  ASSERT_NE(deflation, nullptr);
  EXPECT_GE(deflation->dimension(), 16);
  const Teuchos::RCP<const Map> map = setup.feti.constraints.rowMap();
  const DualOperator& f = setup.feti.dualOperator;
  const MultiVector d = wave(map, 0.37);
  MultiVector before = wave(map, 1.1);
  setup.feti.coarse.project(before); // where it is used: between projections
  MultiVector lambda(before, Teuchos::Copy);
  deflation->complete(d, lambda);
  MultiVector change(lambda, Teuchos::Copy);
  change.update(-1.0, before, 1.0);
  const double size = norm(change);
  EXPECT_GT(size, 1e-3 * norm(before));
  double atBounds = 0.0;
  {
    const auto view = change.getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      if (setup.isEquality(static_cast<int>(r)) == 0.0)
        atBounds = std::max(atBounds, std::abs(view(r, 0)));
  }
  EXPECT_EQ(globalMax(*testComm(), atBounds), 0.0);
  double onMotions = 0.0;
  for (double value : setup.feti.coarse.applyG(change))
    onMotions = std::max(onMotions, std::abs(value));
  EXPECT_LE(onMotions, 1e-12 * size);

  const DeflatedOperator deflated(f, *deflation);
  MultiVector image(map, 1), other(map, 1), load(d, Teuchos::Copy);
  deflation->removeFromLoad(load);
  deflated.apply(before, image);
  image.update(-1.0, load, 1.0); // F'λ − d'
  f.apply(lambda, other);
  other.update(-1.0, d, 1.0); // F(λ + Uα) − d
  // ε of what F makes of threads 1e6 times as stiff.
  const double scale = norm(other) + norm(d) + size;
  image.update(-1.0, other, 1.0);
  setup.feti.coarse.project(image);
  EXPECT_LE(norm(image), 1e-9 * scale);
  deflated.apply(change, image);
  setup.feti.coarse.project(image);
  EXPECT_LE(norm(image), 1e-9 * scale);
}

// The solver's answer is that without vectors, which takes several times the products; contacts and ties,
// vectors from the start and on demand.
TEST(AdaptiveSpace, answers_are_the_same_and_cheap) {
  for (bool tied : {true, false}) {
    const TestModel model = threaded(4, 6, tied);
    const auto solve = [&](const std::string& vectors, const std::string& form) {
      Teuchos::ParameterList list;
      list.sublist("Dual operator").sublist("Expert").set("Adaptive coarse vectors", vectors);
      list.sublist("Dual operator").set("Form", form);
      list.sublist("Dual operator").set("Preconditioner", "Dirichlet");
      list.sublist("Solver").set("Tolerance", 1e-10);
      auto solver = std::make_unique<FetiSolver>(testComm(), model.subdomains, model.rows, list);
      EXPECT_TRUE(solver->solve().converged) << vectors << form;
      return solver;
    };
    const auto without = solve("none", "condensed");
    for (const std::string form : {"condensed", "implicit"}) {
      const auto with = solve("all", form);
      double worst = 0.0, size = 0.0;
      for (std::size_t i = 0; i < with->displacement().size(); ++i)
        for (std::size_t k = 0; k < with->displacement()[i].size(); ++k) {
          size = std::max(size, std::abs(without->displacement()[i][k]));
          worst = std::max(worst, std::abs(with->displacement()[i][k] - without->displacement()[i][k]));
        }
      // Ten tolerances.
      EXPECT_LE(globalMax(*testComm(), worst), 1e-9 * globalMax(*testComm(), size)) << tied << form;
    }
  }
}

TEST(AdaptiveSpace, products_fall) {
  const TestModel model = threaded(6, 8, true);
  const auto report = [&](const std::string& vectors) {
    Teuchos::ParameterList list;
    list.sublist("Dual operator").sublist("Expert").set("Adaptive coarse vectors", vectors);
    list.sublist("Dual operator").set("Form", "condensed");
    list.sublist("Dual operator").set("Preconditioner", "Dirichlet");
    list.sublist("Solver").set("Tolerance", 1e-8);
    FetiSolver solver(testComm(), model.subdomains, model.rows, list);
    return solver.solve();
  };
  const SolveReport none = report("none"), all = report("all");
  const auto products = [](const SolveReport& r) { return r.result.counters.hessianApplications; };
  EXPECT_EQ(none.adaptiveVectors, 0);
  EXPECT_GT(all.adaptiveVectors, 0);
  EXPECT_LE(products(all), 30);
  EXPECT_GE(products(none), 3 * products(all));
}

} // namespace test_adaptive_space
