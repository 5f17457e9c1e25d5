// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LinearConstraint.hpp"

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace Harmos::effects {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' '), end = text.find_last_not_of(' ');
  return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

// "-1.5 body/part x": names may have spaces.
LinearConstraint::Term termFrom(const std::string& text, const scene::Scene& scene, const std::string& path) {
  const std::size_t first = text.find(' '), last = text.rfind(' ');
  char* end = nullptr;
  const double coefficient = std::strtod(text.c_str(), &end);
  const std::size_t component =
      last == std::string::npos ? last : std::string("xyz").find(text.substr(last + 1));
  if (first == std::string::npos || first == last || end != text.c_str() + first ||
      !std::isfinite(coefficient) || text.size() != last + 2 || component == std::string::npos)
    throw InputError("\"" + path + "\" contains the term \"" + text +
                         "\", expected a coefficient, \"body/boundary part\" and x, y or z, as in "
                         "\"-1.5 beam/end x\"",
                     {{"path", path}});
  const std::string part = trimmed(text.substr(first, last - first));
  return {partNamed(scene, part, path), static_cast<int>(component), coefficient};
}

LinearConstraint::Equation equationFrom(const std::string& text, const scene::Scene& scene,
                                        const std::string& path) {
  LinearConstraint::Equation equation;
  std::istringstream terms(text);
  for (std::string term; std::getline(terms, term, ';');)
    equation.terms.push_back(termFrom(trimmed(term), scene, path));
  return equation;
}

std::shared_ptr<const scene::Effect> makeConstraint(const Teuchos::ParameterList& list,
                                                    const std::string& path, const scene::Scene& scene) {
  std::vector<LinearConstraint::Equation> equations;
  for (const std::string& text : list.get<Teuchos::Array<std::string>>("Equations"))
    equations.push_back(equationFrom(text, scene, path + "/Equations"));
  const auto& values = list.get<Teuchos::Array<double>>("Values");
  if (equations.empty())
    throw InputError("\"" + path + "/Equations\" is empty; give at least one equation", {{"path", path}});
  if (!values.empty() && static_cast<std::size_t>(values.size()) != equations.size())
    throw InputError("\"" + path + "/Values\" has " + std::to_string(values.size()) + " numbers for " +
                         std::to_string(equations.size()) +
                         " equations; give one for each, or none for zeros",
                     {{"path", path + "/Values"}});
  for (std::size_t k = 0; k < equations.size() && !values.empty(); ++k)
    equations[k].value = values[static_cast<Teuchos::Ordinal>(k)];
  return std::make_shared<LinearConstraint>(std::move(equations), scene::nameIn(path));
}

} // namespace

scene::EffectKind kindOfLinearConstraint() {
  ParameterSpec spec("<constraint>", "Linear equations of displacements of nodes: Σ coefficient · "
                                     "displacement = value.");
  spec.texts("Equations", {},
             "Terms separated by semicolons: coefficient, \"body/boundary part\" of one node, and x, y or z. "
             "\"1 beam/end x; -1 plate/hole x\". Required.");
  spec.series("Values", Range(),
              "Right-hand side of each equation; none: zeros. \"History\" scales them over the steps.");
  return {LinearConstraint::kindName, spec, makeConstraint, true};
}

LinearConstraint::LinearConstraint(std::vector<Equation> equations, std::string name)
    : Effect(kindName, std::move(name)), equations_(std::move(equations)) {}

bool LinearConstraint::hasMagnitude() const {
  return std::any_of(equations_.begin(), equations_.end(),
                     [](const Equation& equation) { return equation.value != 0.0; });
}

std::vector<scene::Effect::BoundaryPart> LinearConstraint::boundaryParts() const {
  std::vector<BoundaryPart> parts;
  for (const Equation& equation : equations_)
    for (const Term& term : equation.terms)
      parts.push_back({term.part.body, term.part.set, false});
  return parts;
}

void LinearConstraint::check(const scene::Scene& scene) const {
  for (const Equation& equation : equations_)
    for (const Term& term : equation.terms)
      if (term.component < 0 || term.component >= scene.components())
        throw InputError(label() + " names component " + std::to_string(term.component) +
                         ", but the number of components per node is " + std::to_string(scene.components()));
}

void LinearConstraint::addConstraints(scene::ConstraintCollector& collector) const {
  std::vector<std::pair<int, std::string>> parts;
  for (const BoundaryPart& part : boundaryParts())
    parts.emplace_back(part.body, part.set);
  const std::vector<scene::ConstraintCollector::Node> nodes = collector.nodesOf(parts);
  std::size_t next = 0;
  for (const Equation& equation : equations_) {
    scene::ConstraintCollector::Equation row;
    row.value = equation.value;
    for (const Term& term : equation.terms)
      row.terms.push_back({nodes[next++], term.component, term.coefficient});
    collector.addEquation(row);
  }
}

} // namespace Harmos::effects
