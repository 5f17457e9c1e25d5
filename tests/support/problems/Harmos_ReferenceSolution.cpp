// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ReferenceSolution.hpp"

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_LinearComplementarity.hpp"
#include "Harmos_TestComm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Harmos {
namespace {

// The glued problem, the same on every rank.
struct GluedProblem {
  int size = 0;
  std::vector<LongReal> stiffness; // row after row
  std::vector<LongReal> load;
  std::map<int, LongReal> fixed;
  struct Row {
    std::map<int, LongReal> terms;
    LongReal bound = 0.0, compliance = 0.0;
  };
  std::vector<Row> inequalities, equalities; // by number
  std::vector<std::vector<int>> places;      // unknown of each dof of this rank's subdomains

  LongReal& at(int i, int j) {
    return stiffness[static_cast<std::size_t>(i) * static_cast<std::size_t>(size) +
                     static_cast<std::size_t>(j)];
  }
  LongReal at(int i, int j) const { return const_cast<GluedProblem*>(this)->at(i, j); }
};

// A dof by its global number, or an inner one by its subdomain and place there.
struct Name {
  long long subdomain; // −1: a global number
  long long number;
  bool operator<(const Name& other) const {
    return subdomain != other.subdomain ? subdomain < other.subdomain : number < other.number;
  }
};

std::vector<Name> namesOf(const feti::Subdomain& subdomain) {
  std::vector<Name> names;
  for (int i = 0; i < subdomain.stiffness->rows(); ++i)
    names.push_back({subdomain.number, i});
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
    names[static_cast<std::size_t>((*subdomain.interface)[k])] = {-1, subdomain.numbers[k]};
  return names;
}

GluedProblem glue(const Teuchos::Comm<int>& comm, const std::vector<feti::Subdomain>& subdomains,
                  const std::vector<ConstraintRow>& rows) {
  struct Entry {
    Name row, column;
    double value;
  };
  struct Value {
    Name name;
    double value;
  };
  struct Term {
    long long number, dof; // dof −1: the bound, −2: the compliance
    double value;
    int kind;
  };
  std::vector<Entry> entries;
  std::vector<Value> loads, fixed;
  std::vector<Term> terms;
  std::vector<std::vector<Name>> names;
  for (const feti::Subdomain& s : subdomains) {
    names.push_back(namesOf(s));
    const std::vector<Name>& own = names.back();
    for (std::size_t i = 0; i < own.size(); ++i) {
      loads.push_back({own[i], (*s.load)[i]});
      for (std::size_t k = s.stiffness->offsets[i]; k < s.stiffness->offsets[i + 1]; ++k)
        entries.push_back(
            {own[i], own[static_cast<std::size_t>(s.stiffness->columns[k])], s.stiffness->values[k]});
    }
    for (const feti::FixedDof& f : s.fixed)
      fixed.push_back({own[static_cast<std::size_t>(f.dof)], f.value});
  }
  for (const ConstraintRow& row : rows) {
    const int kind = row.kind == ConstraintRow::Kind::Inequality ? 0 : 1;
    terms.push_back({row.number, -1, row.bound, kind});
    terms.push_back({row.number, -2, row.compliance, kind});
    for (const ConstraintRow::Term& term : row.terms)
      terms.push_back({row.number, term.dof, term.coefficient, kind});
  }

  GluedProblem problem;
  std::map<Name, int> unknown;
  const std::vector<Value> allLoads = gatherAll(comm, loads);
  for (const Value& item : allLoads)
    unknown.emplace(item.name, static_cast<int>(unknown.size()));
  problem.size = static_cast<int>(unknown.size());
  const auto n = static_cast<std::size_t>(problem.size);
  problem.stiffness.assign(n * n, 0.0);
  problem.load.assign(n, 0.0);
  for (const Value& item : allLoads)
    problem.load[static_cast<std::size_t>(unknown.at(item.name))] += item.value;
  for (const Entry& entry : gatherAll(comm, entries))
    problem.at(unknown.at(entry.row), unknown.at(entry.column)) += entry.value;
  for (const Value& item : gatherAll(comm, fixed))
    problem.fixed[unknown.at(item.name)] = item.value;
  for (const Term& term : gatherAll(comm, terms)) {
    auto& into = term.kind == 0 ? problem.inequalities : problem.equalities;
    if (into.size() <= static_cast<std::size_t>(term.number))
      into.resize(static_cast<std::size_t>(term.number) + 1);
    GluedProblem::Row& row = into[static_cast<std::size_t>(term.number)];
    if (term.dof < 0)
      (term.dof == -1 ? row.bound : row.compliance) += term.value;
    else
      row.terms[unknown.at({-1, term.dof})] += term.value;
  }
  for (const std::vector<Name>& own : names) {
    std::vector<int> places;
    for (const Name& name : own)
      places.push_back(unknown.at(name));
    problem.places.push_back(places);
  }
  return problem;
}

// The saddle-point system in free unknowns x = u/√k_ii and rows of length one there.
struct SaddleSystem {
  explicit SaddleSystem(const GluedProblem& problem) {
    place.assign(static_cast<std::size_t>(problem.size), -1);
    for (int i = 0; i < problem.size; ++i)
      if (problem.fixed.count(i) == 0) {
        place[static_cast<std::size_t>(i)] = static_cast<int>(free.size());
        free.push_back(i);
        const LongReal diagonal = problem.at(i, i);
        scale.push_back(diagonal > 0.0 ? 1.0 / std::sqrt(diagonal) : LongReal(1.0));
      }
    const auto addRows = [&](const std::vector<GluedProblem::Row>& from, bool inequality) {
      for (std::size_t k = 0; k < from.size(); ++k) {
        std::map<int, LongReal> terms;
        LongReal bound = from[k].bound, squares = 0.0;
        for (const auto& [i, value] : from[k].terms) {
          const int p = place[static_cast<std::size_t>(i)];
          if (p < 0) {
            bound -= value * problem.fixed.at(i);
            continue;
          }
          const LongReal scaled = value * scale[static_cast<std::size_t>(p)];
          if (scaled != 0.0)
            terms[p] = scaled;
          squares += scaled * scaled;
        }
        if (terms.empty())
          continue; // of prescribed values alone
        const LongReal length = std::sqrt(squares);
        for (auto& term : terms)
          term.second /= length;
        rows.push_back({terms, bound / length, from[k].compliance / (length * length)});
        lengths.push_back(length);
        if (inequality)
          inequalities.push_back(static_cast<int>(k));
      }
    };
    addRows(problem.inequalities, true);
    addRows(problem.equalities, false);
    const int order = static_cast<int>(free.size() + rows.size());
    matrix = DenseReal(order, order);
    rhs.assign(static_cast<std::size_t>(order), 0.0);
    const int n = static_cast<int>(free.size());
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::size_t>(i);
      LongReal load = problem.load[static_cast<std::size_t>(free[a])];
      for (const auto& [j, value] : problem.fixed)
        load -= problem.at(free[a], j) * value;
      rhs[a] = load * scale[a];
      for (int j = 0; j < n; ++j) {
        const auto b = static_cast<std::size_t>(j);
        matrix(i, j) = problem.at(free[a], free[b]) * scale[a] * scale[b];
      }
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const int r = n + static_cast<int>(k);
      rhs[static_cast<std::size_t>(r)] = rows[k].bound;
      matrix(r, r) = -rows[k].compliance; // Bu = c + Cλ
      for (const auto& [i, value] : rows[k].terms)
        matrix(r, i) = matrix(i, r) = value;
    }
  }

  std::vector<int> free, place;
  std::vector<LongReal> scale;
  std::vector<GluedProblem::Row> rows; // inequalities, then equalities
  std::vector<LongReal> lengths;
  std::vector<int> inequalities; // their numbers
  DenseReal matrix;
  std::vector<LongReal> rhs;
};

// Largest violation of the optimality conditions, relative to the largest of the terms in each kind.
LongReal optimalityDefect(const SaddleSystem& system, const std::vector<LongReal>& x,
                          const std::vector<LongReal>& slack) {
  const auto n = system.free.size(), m = system.inequalities.size();
  LongReal forces = 0.0, force = 0.0, lengths = 0.0, length = 0.0, sign = 0.0;
  for (std::size_t r = 0; r < x.size(); ++r) {
    LongReal sum = -system.rhs[r], terms = std::abs(system.rhs[r]);
    for (std::size_t c = 0; c < x.size(); ++c) {
      const LongReal term = system.matrix(static_cast<int>(r), static_cast<int>(c)) * x[c];
      sum += term;
      terms = std::max(terms, std::abs(term));
    }
    if (r >= n && r < n + m) {
      sum += slack[r - n];
      terms = std::max(terms, std::abs(slack[r - n]));
    }
    (r < n ? force : length) = std::max(r < n ? force : length, std::abs(sum));
    (r < n ? forces : lengths) = std::max(r < n ? forces : lengths, terms);
  }
  for (std::size_t k = 0; k < n; ++k) // rows of length one: a gap may be closed to rounding errors
    lengths = std::max(lengths, std::abs(x[k]));
  LongReal product = 0.0;
  for (std::size_t k = 0; k < m; ++k)
    product += std::abs(x[n + k] * slack[k]);
  for (std::size_t k = 0; k < m; ++k) {
    if (forces > 0.0)
      sign = std::max(sign, -x[n + k] / forces);
    if (lengths > 0.0)
      sign = std::max(sign, -slack[k] / lengths);
  }
  const auto relative = [](LongReal value, LongReal scale) {
    return scale > 0.0 ? value / scale : LongReal(0.0);
  };
  return std::max(
      {relative(force, forces), relative(length, lengths), sign, relative(product, forces * lengths)});
}

feti::TornVector torn(const GluedProblem& problem, const std::vector<LongReal>& u) {
  feti::TornVector result;
  for (const std::vector<int>& places : problem.places) {
    result.emplace_back();
    for (int i : places)
      result.back().push_back(static_cast<double>(u[static_cast<std::size_t>(i)]));
  }
  return result;
}

double product(const Teuchos::Comm<int>& comm, const feti::TornVector& a, const feti::TornVector& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k)
      sum += a[i][k] * b[i][k];
  return globalSum(comm, sum);
}

void add(double factor, const feti::TornVector& x, feti::TornVector& y) {
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t k = 0; k < x[i].size(); ++k)
      y[i][k] += factor * x[i][k];
}

double largestOf(const Teuchos::Comm<int>& comm, const feti::TornVector& x) {
  double largest = 0.0;
  for (const std::vector<double>& part : x)
    for (double value : part)
      largest =
          std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(largest, std::abs(value));
  return globalMax(comm, largest);
}

} // namespace

ReferenceSolution referenceSolution(const Teuchos::Comm<int>& comm,
                                    const std::vector<feti::Subdomain>& subdomains,
                                    const std::vector<ConstraintRow>& rows) {
  const GluedProblem problem = glue(comm, subdomains, rows);
  const SaddleSystem system(problem);
  const auto n = system.free.size(), m = system.inequalities.size();
  // Columns: the load, and a unit slack of each inequality.
  std::vector<std::vector<LongReal>> columns = {system.rhs};
  for (std::size_t k = 0; k < m; ++k) {
    std::vector<LongReal> column(system.rhs.size(), 0.0);
    column[n + k] = -1.0;
    columns.push_back(column);
  }
  // Rounding of K, which is given in 53 bits, leaves 1e-16 of a free motion's stiffness.
  const FullPivotElimination elimination(system.matrix, 1e-13L);
  ReferenceSolution result;
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (!elimination.solve(columns[k])) {
      HARMOS_REQUIRE(k == 0, "inequalities of a reference solution are dependent");
      result.solvable = false;
      return result;
    }
  std::vector<LongReal> q;
  DenseReal h(static_cast<int>(m), static_cast<int>(m));
  for (std::size_t r = 0; r < m; ++r) {
    q.push_back(columns[0][n + r]);
    for (std::size_t c = 0; c < m; ++c)
      h(static_cast<int>(r), static_cast<int>(c)) = columns[c + 1][n + r];
  }
  std::vector<LongReal> slack(m, 0.0);
  if (!solveLinearComplementarity(h, q, slack)) {
    result.solvable = false;
    return result;
  }
  std::vector<LongReal> x = columns[0];
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t r = 0; r < x.size(); ++r)
      x[r] += slack[k] * columns[k + 1][r];
  const LongReal defect = optimalityDefect(system, x, slack);
  HARMOS_REQUIRE(defect <= 1e-12L, "the reference solution misses its optimality conditions by " +
                                       std::to_string(static_cast<double>(defect)));

  std::vector<LongReal> u(static_cast<std::size_t>(problem.size), 0.0);
  for (const auto& [i, value] : problem.fixed)
    u[static_cast<std::size_t>(i)] = value;
  for (std::size_t i = 0; i < n; ++i)
    u[static_cast<std::size_t>(system.free[i])] = x[i] * system.scale[i];
  result.force.assign(problem.inequalities.size(), 0.0);
  result.gap.assign(problem.inequalities.size(), 0.0);
  for (std::size_t k = 0; k < m; ++k)
    result.force[static_cast<std::size_t>(system.inequalities[k])] =
        static_cast<double>(x[n + k] / system.lengths[k]);
  for (std::size_t k = 0; k < problem.inequalities.size(); ++k) {
    LongReal gap = problem.inequalities[k].bound;
    for (const auto& [i, value] : problem.inequalities[k].terms)
      gap -= value * u[static_cast<std::size_t>(i)];
    result.gap[k] = static_cast<double>(gap);
  }
  LongReal energy = 0.0;
  for (int i = 0; i < problem.size; ++i) {
    const auto a = static_cast<std::size_t>(i);
    LongReal image = 0.0;
    for (int j = 0; j < problem.size; ++j)
      image += problem.at(i, j) * u[static_cast<std::size_t>(j)];
    energy += u[a] * (0.5L * image - problem.load[a]);
  }
  result.energy = static_cast<double>(energy);
  result.displacement = torn(problem, u);
  result.largestDisplacement = largestOf(comm, result.displacement);
  for (const std::vector<LongReal>& motion : elimination.kernel()) {
    std::vector<LongReal> v(static_cast<std::size_t>(problem.size), 0.0);
    for (std::size_t i = 0; i < n; ++i)
      v[static_cast<std::size_t>(system.free[i])] = motion[i] * system.scale[i];
    feti::TornVector t = torn(problem, v);
    const double before = std::sqrt(product(comm, t, t));
    for (int sweep = 0; sweep < 2; ++sweep)
      for (const feti::TornVector& other : result.freeMotions)
        add(-product(comm, other, t), other, t);
    const double length = std::sqrt(product(comm, t, t));
    if (!(length > 1e-8 * before)) // multipliers of dependent equalities, which move nothing
      continue;
    for (std::vector<double>& part : t)
      for (double& value : part)
        value /= length;
    result.freeMotions.push_back(std::move(t));
  }
  return result;
}

ReferenceSolution referenceSolution(const scene::Scene& scene) {
  const auto comm = testComm();
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*comm, scene);
  return referenceSolution(*comm, scene::assemble(scene, owned),
                           scene::setUpContact(*comm, scene, owned).rows);
}

double Deviation::largest() const {
  return std::max({displacement, force, energy});
}

Deviation deviation(const ReferenceSolution& reference, const feti::TornVector& displacement,
                    const std::vector<double>& force, double energy) {
  const auto comm = testComm();
  const auto relative = [](double value, double scale) {
    const double result = scale > 0.0 ? value / scale : value;
    return std::isnan(result) ? std::numeric_limits<double>::infinity() : result;
  };
  Deviation result;
  feti::TornVector difference = displacement;
  add(-1.0, reference.displacement, difference);
  for (const feti::TornVector& motion : reference.freeMotions)
    add(-product(*comm, motion, difference), motion, difference);
  result.displacement = relative(largestOf(*comm, difference), reference.largestDisplacement);
  double largest = 0.0, off = 0.0;
  HARMOS_REQUIRE(force.size() == reference.force.size(), "as many forces as inequalities are to be compared");
  for (std::size_t k = 0; k < force.size(); ++k) {
    largest = std::max(largest, std::abs(reference.force[k]));
    const double one = std::abs(force[k] - reference.force[k]);
    off = one <= off ? off : one; // keeps a NaN
  }
  result.force = relative(off, largest);
  result.energy = relative(std::abs(energy - reference.energy), std::abs(reference.energy));
  return result;
}

Deviation deviation(const ReferenceSolution& reference, const feti::FetiSolver& solver) {
  std::vector<double> force(static_cast<std::size_t>(solver.constraints()->inequalities()), 0.0);
  const feti::ContactState state = solver.contact();
  for (std::size_t k = 0; k < state.row.size(); ++k)
    force[static_cast<std::size_t>(state.row[k])] = state.force[k];
  globalSum(*testComm(), force);
  return deviation(reference, solver.displacement(), force, solver.audit().primalEnergy);
}

Deviation deviation(const ReferenceSolution& reference, const TestRun& run) {
  std::vector<double> force;
  for (const run::ContactState& state : run.report.contact)
    force.push_back(state.force);
  return deviation(reference, run.solution.displacement, force, run.report.audit.energy);
}

} // namespace Harmos
