// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Quantity.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_Rendezvous.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {
namespace {

using Kind = Quantity::Kind;

// Its place among the effects; throws if there is none.
std::size_t effectOf(const scene::Scene& scene, const std::string& path) {
  const std::vector<std::string> paths = scene.effectPaths();
  const auto place = std::find(paths.begin(), paths.end(), path);
  if (place == paths.end()) {
    std::string all;
    for (const std::string& other : paths)
      all += (all.empty() ? "\"" : ", \"") + other + "\"";
    throw InputError("\"Adaptivity/Of\" names \"" + path +
                     "\", which is no effect of the deck; there are: " + all);
  }
  return static_cast<std::size_t>(place - paths.begin());
}

// "body/part".
std::pair<int, std::string> partOf(const scene::Scene& scene, const std::string& path) {
  const std::size_t slash = path.find('/');
  for (std::size_t b = 0; b < scene.bodies.size() && slash != std::string::npos; ++b)
    if (scene.bodies[b].name == path.substr(0, slash))
      return {static_cast<int>(b), path.substr(slash + 1)};
  throw InputError("\"Adaptivity/Of\" is \"" + path +
                   "\"; of a displacement it names a boundary part, as \"body/boundary part\"");
}

double along(const fem::Point& a, const fem::Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

feti::TornVector zeros(const AnswerParts& answer) {
  return answer.system.zeroVector();
}

// ∫ over the part by the basis functions, or a share of each node, so that a constant has its own value.
feti::TornVector meanOver(const Teuchos::Comm<int>& comm, const Quantity& quantity,
                          const AnswerParts& answer) {
  const auto [body, name] = partOf(answer.scene, quantity.of);
  const auto components = static_cast<std::size_t>(answer.scene.components());
  feti::TornVector sides = zeros(answer), nodes = zeros(answer);
  std::vector<double> total(2, 0.0);
  const auto add = [&](feti::TornVector& weights, std::size_t i, int node, double weight) {
    for (std::size_t c = 0; c < components; ++c)
      weights[i][static_cast<std::size_t>(node) * components + c] +=
          weight * quantity.direction[components == 1 ? 2 : c];
  };
  std::vector<std::pair<long long, int>> known;
  std::vector<long long> asked;
  for (const scene::OwnedSubdomain& item : answer.owned)
    if (const auto set = item.mesh.sets.find(name); item.body == body && set != item.mesh.sets.end())
      for (int node : set->second) {
        known.emplace_back(item.mesh.number(node), 1);
        asked.push_back(item.mesh.number(node));
      }
  const std::vector<std::optional<int>> copies =
      lookUpMerged(comm, known, asked, [](int& present, int next) { present += next; });
  std::size_t next = 0;
  for (std::size_t i = 0; i < answer.owned.size(); ++i) {
    const fem::PlacedMesh& placed = answer.owned[i].mesh;
    if (answer.owned[i].body != body)
      continue;
    if (const auto set = placed.sets.find(name); set != placed.sets.end())
      for (int node : set->second) {
        const double share = 1.0 / *copies[next++];
        add(nodes, i, node, share);
        total[1] += share;
      }
    const auto part = placed.sides.find(name);
    if (part == placed.sides.end())
      continue;
    fem::visitSides(*placed.mesh, part->second, 2 * fem::shapeOf(placed.mesh->cellType).order,
                    [&](const fem::SidePoint& point) {
                      for (std::size_t k = 0; k < point.nodes.size(); ++k)
                        add(sides, i, point.nodes[k], point.measure * point.values[k]);
                      total[0] += point.measure;
                    });
  }
  globalSum(comm, total);
  if (total[1] == 0.0)
    throw InputError("\"Adaptivity/Of\": body \"" + answer.scene.bodies[static_cast<std::size_t>(body)].name +
                     "\" has no boundary part \"" + name + "\"; --parts tells those that it has");
  feti::TornVector& weights = total[0] > 0.0 ? sides : nodes;
  for (std::vector<double>& values : weights)
    for (double& value : values)
      value /= total[0] > 0.0 ? total[0] : total[1];
  return weights;
}

// Unit displacements where the effect prescribes them; nothing if it does not.
std::optional<feti::TornVector> unitAt(const Teuchos::Comm<int>& comm, const scene::Effect& effect,
                                       const fem::Point& direction, const AnswerParts& answer) {
  feti::TornVector unit = zeros(answer);
  const auto components = static_cast<std::size_t>(answer.scene.components());
  const std::vector<int> bodies = effect.bodies();
  long long fixed = 0;
  for (std::size_t i = 0; i < answer.owned.size(); ++i) {
    if (std::find(bodies.begin(), bodies.end(), answer.owned[i].body) == bodies.end())
      continue;
    std::vector<feti::FixedDof> part;
    effect.addPrescribed(answer.scene, answer.owned[i], part);
    fixed += static_cast<long long>(part.size());
    for (const feti::FixedDof& dof : part)
      unit[i][static_cast<std::size_t>(dof.dof)] =
          direction[components == 1 ? 2 : static_cast<std::size_t>(dof.dof) % components];
  }
  return globalSum(comm, fixed) > 0 ? std::optional(std::move(unit)) : std::nullopt;
}

// The loads −Kw of what is known, and bounds −Bw.
void leave(const Teuchos::Comm<int>& comm, const AnswerParts& answer, const feti::TornVector& known,
           AdjointProblem& problem, feti::TornVector& loads) {
  std::vector<std::pair<long long, double>> values;
  for (std::size_t i = 0; i < answer.owned.size(); ++i) {
    const feti::Subdomain& subdomain = answer.system.subdomain(static_cast<int>(i));
    std::vector<double> product(known[i].size(), 0.0);
    subdomain.stiffness->multiply(known[i].data(), product.data());
    for (std::size_t k = 0; k < product.size(); ++k)
      loads[i][k] -= product[k];
    for (std::size_t k = 0; k < subdomain.interface->size(); ++k)
      if (const double value = known[i][static_cast<std::size_t>((*subdomain.interface)[k])]; value != 0.0)
        values.emplace_back(subdomain.numbers[k], value);
  }
  std::vector<long long> asked;
  for (const ConstraintRow& row : problem.rows)
    for (const ConstraintRow::Term& term : row.terms)
      asked.push_back(term.dof);
  const std::vector<std::optional<double>> at =
      lookUpMerged(comm, values, asked, [](double&, double) {}); // copies are alike
  std::size_t next = 0;
  for (ConstraintRow& row : problem.rows)
    for (const ConstraintRow::Term& term : row.terms)
      if (const std::optional<double>& value = at[next++]; value && row.status != ConstraintRow::Status::Open)
        row.bound -= term.coefficient * *value;
}

// The value of a peak pressure; the derivatives by the forces of rows become their bounds.
double setPeak(const Teuchos::Comm<int>& comm, const scene::Effect& effect, const AnswerParts& answer,
               std::vector<ConstraintRow>& rows) {
  std::vector<double> forces(rows.size(), 0.0), areas(rows.size(), 0.0);
  std::size_t point = 0; // inequality rows are those of the points, in their order
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].kind == ConstraintRow::Kind::Inequality) {
      areas[r] = answer.contact.points[point++].area;
      if (answer.contact.origins[r].effect == &effect)
        forces[r] = answer.multipliers[r];
    }
  const PeakOfPressure peak = peakOfPressure(comm, forces, areas);
  if (peak.value <= 0.0)
    throw InputError("\"Adaptivity/Quantity\" = \"peak pressure\": nothing bears a force at \"" +
                     effect.label() + "\"");
  for (std::size_t r = 0; r < rows.size(); ++r)
    rows[r].bound = peak.derivatives[r];
  return peak.value;
}

} // namespace

void Quantity::check(const scene::Scene& scene) const {
  for (const auto& effect : scene.effects)
    if (effect->interfaceLaw() != nullptr)
      throw InputError("\"Adaptivity/Quantity\" does not go with friction or adhesion (" + effect->label() +
                       "): what slips or breaks has no derivative of this kind; use \"energy\"");
  if (kind == Kind::Displacement) {
    partOf(scene, of);
    return;
  }
  const scene::Effect& effect = *scene.effects[effectOf(scene, of)];
  if (kind == Kind::PeakPressure && !effect.givesInequalities())
    throw InputError("\"Adaptivity/Of\": " + effect.label() + " has no contact pressure");
  if (kind == Kind::Force && !effect.exertsForce())
    throw InputError("\"Adaptivity/Of\": " + effect.label() +
                     " exerts no force; those of contacts, obstacles and prescribed displacements are known");
}

PeakOfPressure peakOfPressure(const Teuchos::Comm<int>& comm, const std::vector<double>& forces,
                              const std::vector<double>& areas) {
  constexpr double n = 8.0;
  PeakOfPressure result;
  result.derivatives.assign(forces.size(), 0.0);
  std::vector<double> pressure(forces.size(), 0.0);
  for (std::size_t r = 0; r < forces.size(); ++r)
    pressure[r] = areas[r] > 0.0 ? std::max(0.0, forces[r] / areas[r]) : 0.0;
  const double largest =
      globalMax(comm, pressure.empty() ? 0.0 : *std::max_element(pressure.begin(), pressure.end()));
  if (largest <= 0.0)
    return result;
  std::vector<double> sums(2, 0.0); // of p over the largest: powers neither vanish nor overflow
  for (std::size_t r = 0; r < forces.size(); ++r) {
    sums[0] += areas[r] * std::pow(pressure[r] / largest, n);
    sums[1] += areas[r] * std::pow(pressure[r] / largest, n + 1.0);
  }
  globalSum(comm, sums);
  const double value = sums[1] / sums[0]; // over the largest
  for (std::size_t r = 0; r < forces.size(); ++r)
    if (const double p = pressure[r] / largest; p > 0.0)
      result.derivatives[r] = ((n + 1.0) * std::pow(p, n) - n * value * std::pow(p, n - 1.0)) / sums[0];
  result.value = value * largest;
  return result;
}

AdjointProblem adjointProblem(const Teuchos::Comm<int>& comm, const Quantity& quantity,
                              const AnswerParts& answer) {
  AdjointProblem problem;
  problem.rows = answer.contact.rows;
  for (std::size_t r = 0; r < problem.rows.size(); ++r) {
    ConstraintRow& row = problem.rows[r];
    row.bound = row.rounding = 0.0;
    if (row.kind == ConstraintRow::Kind::Inequality)
      row.status = answer.multipliers[r] > 0.0 ? ConstraintRow::Status::Closed : ConstraintRow::Status::Open;
  }
  feti::TornVector loads = zeros(answer);
  if (quantity.kind == Kind::Displacement) {
    loads = meanOver(comm, quantity, answer);
    for (std::size_t i = 0; i < loads.size(); ++i)
      for (std::size_t k = 0; k < loads[i].size(); ++k)
        problem.value += loads[i][k] * answer.displacement[i][k];
    problem.value = globalSum(comm, problem.value);
  } else {
    const std::size_t place = effectOf(answer.scene, quantity.of);
    const scene::Effect& effect = *answer.scene.effects[place];
    if (quantity.kind == Kind::PeakPressure) {
      problem.value = setPeak(comm, effect, answer, problem.rows);
    } else {
      for (const Forces::Of& force : answer.forces.effects)
        if (force.path == quantity.of)
          problem.value = along(force.resultant.force, quantity.direction);
      if (std::optional<feti::TornVector> unit = unitAt(comm, effect, quantity.direction, answer)) {
        leave(comm, answer, *unit, problem, loads);
        problem.known = std::move(*unit);
      } else {
        for (std::size_t r = 0; r < problem.rows.size(); ++r)
          if (answer.contact.origins[r].effect == &effect)
            problem.rows[r].bound = -along(answer.contact.origins[r].direction, quantity.direction);
      }
    }
  }
  for (ConstraintRow& row : problem.rows)
    if (row.status == ConstraintRow::Status::Open)
      row.bound = 0.0;
  for (std::vector<double>& load : loads)
    problem.loads.push_back(std::make_shared<const std::vector<double>>(std::move(load)));
  return problem;
}

} // namespace Harmos::run
