// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_HardCase.hpp"

#include "Harmos_ContactSetup.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FormChoice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>

namespace Harmos {

scene::Scene valley(const Valley& o) {
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.size = {o.length, o.length, 0.0};
  options.subdomains = {o.subdomains, o.subdomains, 1};
  options.elements = {o.elements, o.elements, 1};
  const double length = o.length;
  options.map = [length](const fem::Point& x) {
    const double bend = x[1] <= length ? x[1] : 2.0 * length - x[1];
    return fem::Point{x[0], x[1] + 0.5 * std::abs(x[0] / length - 0.5) * bend, 0.0};
  };
  scene.bodies.push_back(blockBody("valley", options, fem::Material::isotropic(o.modulus, 0.3)));
  options.origin[1] = length;
  scene.bodies.push_back(blockBody("floating", options, fem::Material::isotropic(2.0 * o.modulus, 0.25)));
  for (int component : {0, 1})
    prescribe(scene, {0, o.held[static_cast<std::size_t>(component)]}, component);
  const double unit = o.modulus / length;
  addForce(scene, 1, {o.aside * unit, -o.load * unit, 0.0});
  addContact(scene, {0, "top"}, {1, "bottom"}, o.gap * length);
  return scene;
}

contact::Obstacle halfSpace(const fem::Point& point, const fem::Point& direction) {
  contact::Obstacle obstacle;
  obstacle.point = point;
  obstacle.direction = direction;
  return obstacle;
}

double products(const run::RunReport& report) {
  return report.result.counters.hessianApplications;
}

TestModel modelOf(const scene::Scene& scene) {
  const auto comm = testComm();
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*comm, scene);
  TestModel model;
  model.subdomains = scene::assemble(scene, owned);
  model.rows = scene::setUpContact(*comm, scene, owned).rows;
  return model;
}

namespace {

feti::PreconditionerKind preconditionerOf(const run::RunOptions& options) {
  return options.dual.preconditioner.value_or(feti::PreconditionerKind::Dirichlet);
}

} // namespace

TornRun solveTorn(const TestModel& model, double tolerance, const std::vector<std::string>& assignments) {
  const run::RunOptions options = testOptions(tolerance, assignments);
  feti::LocalInverseOptions inverses = options.dual.inverses;
  inverses.form = options.dual.form.value_or(feti::DualForm::Condensed);
  return solveTorn(TestFeti(model, options.dirichlet.value_or(feti::DirichletForm::Primal), inverses),
                   tolerance, assignments);
}

TornRun solveTorn(const TestFeti& feti, double tolerance, const std::vector<std::string>& assignments) {
  const run::RunOptions options = testOptions(tolerance, assignments);
  Teuchos::RCP<const feti::DualPreconditioner> preconditioner;
  if (preconditionerOf(options) != feti::PreconditionerKind::None)
    preconditioner = Teuchos::rcp(new feti::DualPreconditioner(
        feti.system, feti.constraints, feti.inverses, preconditionerOf(options),
        options.dual.scaling.value_or(feti::PreconditionerScaling::Multiplicity)));
  TornRun run;
  run.report.tolerance = tolerance;
  run.report.inequalities = feti.constraints.inequalities();
  const feti::DualSolution solution = feti::solveDualProblem(
      {Teuchos::rcpFromRef(feti.system), Teuchos::rcpFromRef(feti.constraints),
       Teuchos::rcpFromRef(feti.inverses), Teuchos::rcpFromRef<const feti::CoarseSpace>(feti.coarse),
       Teuchos::rcpFromRef(feti.dual), preconditioner, Teuchos::null},
      options, nullptr, {}, Log(), run.report);
  run.torn = feti::recover(feti.system, feti.constraints, feti.inverses, feti.coarse, feti.dual,
                           *solution.lambda, solution.mu);
  run.mu = solution.mu;
  run.report.audit = feti::audit(feti.system, feti.constraints, run.torn);
  run.report.audited = true;
  const feti::ContactState state = feti::contactState(feti.constraints, run.torn);
  run.force.assign(static_cast<std::size_t>(feti.constraints.inequalities()), 0.0);
  for (std::size_t k = 0; k < state.row.size(); ++k)
    run.force[static_cast<std::size_t>(state.row[k])] = state.force[k];
  globalSum(*testComm(), run.force);
  return run;
}

Deviation deviation(const ReferenceSolution& reference, const TornRun& run) {
  return deviation(reference, run.torn.displacement, run.force, run.report.audit.energy);
}

namespace {

void expectSound(const ReferenceSolution& reference, const run::RunReport& report, const Deviation& off,
                 double bound, const std::string& what) {
  EXPECT_TRUE(reference.solvable) << what;
  EXPECT_TRUE(report.converged) << what << ": " << report.reason;
  EXPECT_TRUE(feti::auditAgrees(report)) << what << "\n" << run::auditText(report);
  EXPECT_LE(off.displacement, bound) << what;
  EXPECT_LE(off.force, bound) << what;
  EXPECT_LE(off.energy, bound) << what;
  EXPECT_GE(report.audit.minContactMultiplier, -bound * report.audit.largestMultiplier) << what;
}

} // namespace

void expectReference(const ReferenceSolution& reference, const TestRun& run, double bound,
                     const std::string& what) {
  expectSound(reference, run.report, deviation(reference, run), bound, what);
}

void expectReference(const ReferenceSolution& reference, const TornRun& run, double bound,
                     const std::string& what) {
  expectSound(reference, run.report, deviation(reference, run), bound, what);
}

void tellFigure(const std::string& name, double value) {
  std::ostringstream text;
  text.precision(3);
  text << value;
  testing::Test::RecordProperty(name, text.str());
  if (testComm()->getRank() == 0)
    std::cout << "[  figure  ] " << name << ": " << text.str() << std::endl;
}

TestModel withRows(const TestModel& model, Gluing gluing, Copies copies) {
  const auto comm = testComm();
  struct Copy {
    long long dof, subdomain;
    int fixed;
  };
  std::vector<Copy> mine;
  for (const feti::Subdomain& s : model.subdomains)
    for (std::size_t k = 0; k < s.numbers.size(); ++k) {
      const int dof = (*s.interface)[k];
      mine.push_back({s.numbers[k], s.number,
                      std::any_of(s.fixed.begin(), s.fixed.end(),
                                  [dof](const feti::FixedDof& f) { return f.dof == dof; })
                          ? 1
                          : 0});
    }
  std::map<long long, std::vector<Copy>> table;
  for (const Copy& copy : gatherAll(*comm, mine))
    table[copy.dof].push_back(copy);
  // Its own number for each copy, by dofs and subdomains: the same on any number of ranks.
  std::map<std::pair<long long, long long>, long long> number;
  for (auto& [dof, list] : table) {
    std::sort(list.begin(), list.end(),
              [](const Copy& a, const Copy& b) { return a.subdomain < b.subdomain; });
    for (const Copy& copy : list)
      number.emplace(std::make_pair(dof, copy.subdomain), static_cast<long long>(number.size()));
  }

  TestModel result = model;
  for (feti::Subdomain& s : result.subdomains)
    for (long long& dof : s.numbers)
      dof = number.at({dof, s.number});
  long long equalities = 0;
  for (const ConstraintRow& row : model.rows)
    equalities += row.kind == ConstraintRow::Kind::Equality ? 1 : 0;
  equalities = globalSum(*comm, equalities);
  for (ConstraintRow& row : result.rows) {
    std::vector<ConstraintRow::Term> terms;
    for (const ConstraintRow::Term& term : row.terms) {
      const std::vector<Copy>& list = table.at(term.dof);
      const std::size_t taken = copies == Copies::Mean ? list.size() : 1;
      for (std::size_t k = 0; k < taken; ++k)
        terms.push_back(
            {number.at({term.dof, list[k].subdomain}), term.coefficient / static_cast<double>(taken)});
    }
    row.terms = terms;
  }
  if (comm->getRank() != 0)
    return result;
  // Of a bound of zero feti::Constraints would make gluing rows again.
  constexpr double nothing = std::numeric_limits<double>::min();
  const auto add = [&](const std::vector<ConstraintRow::Term>& terms) {
    result.rows.push_back({ConstraintRow::Kind::Equality, equalities++, terms, nothing, 1e-300});
  };
  for (const auto& [dof, list] : table)
    for (std::size_t k = 1; k < list.size(); ++k) {
      const auto at = [&](std::size_t i) { return number.at({dof, list[i].subdomain}); };
      switch (gluing) {
      case Gluing::Orthonormal: {
        std::vector<ConstraintRow::Term> terms;
        for (std::size_t i = 0; i < k; ++i)
          terms.push_back({at(i), 1.0});
        terms.push_back({at(k), -static_cast<double>(k)});
        add(terms);
        break;
      }
      case Gluing::Chain:
        add({{at(k - 1), 1.0}, {at(k), -1.0}});
        break;
      case Gluing::AllPairs:
        for (std::size_t i = 0; i < k; ++i)
          add({{at(i), 1.0}, {at(k), -1.0}});
        break;
      }
    }
  return result;
}

double conditionOfRows(const TestModel& model) {
  const auto comm = testComm();
  const feti::SubdomainSystem system(comm, model.subdomains, feti::DirichletForm::Primal);
  const feti::Constraints constraints(system, model.rows);
  struct Entry {
    long long row, subdomain;
    int dof;
    double value;
  };
  std::vector<Entry> entries;
  for (int i = 0; i < system.size(); ++i)
    for (const feti::Constraints::Entry& entry : constraints.entries(i))
      entries.push_back({static_cast<long long>(constraints.overlapMap()->getGlobalElement(entry.row)),
                         system.subdomain(i).number, entry.dof, entry.value});
  std::map<std::pair<long long, int>, std::vector<std::pair<int, double>>> byDof;
  for (const Entry& entry : gatherAll(*comm, entries))
    byDof[{entry.subdomain, entry.dof}].emplace_back(static_cast<int>(entry.row), entry.value);
  const int n = static_cast<int>(constraints.dualDimension());
  Dense gram(n, n);
  for (const auto& item : byDof)
    for (const auto& [a, x] : item.second)
      for (const auto& [b, y] : item.second)
        gram(a, b) += x * y;
  const std::vector<double> spectrum = eigenvalues(gram);
  return spectrum.front() > 1e-12 * spectrum.back() ? spectrum.back() / spectrum.front()
                                                    : std::numeric_limits<double>::infinity();
}

} // namespace Harmos
