// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RolOptions.hpp"

#include "Harmos_DesignAdapters.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_LinearLimits.hpp"
#include "Harmos_NearestName.hpp"

#include <ROL_Solver.hpp>

#include <string>
#include <vector>

namespace Harmos::rol {

namespace {

// Names of the methods of a family; ROL takes its default for any other, without a word.
template<class Enum, class Name>
std::vector<std::string> methods(Enum last, Name name) {
  std::vector<std::string> result;
  for (int k = 0; k < static_cast<int>(last); ++k)
    result.push_back(name(static_cast<Enum>(k)));
  return result;
}

std::vector<std::string> methodsForBounds() {
  return methods(ROL::TypeB::ALGORITHM_B_LAST, ROL::TypeB::EAlgorithmBToString);
}

std::vector<std::string> methodsForConstraints() {
  return methods(ROL::TypeG::ALGORITHM_G_LAST, ROL::TypeG::EAlgorithmGToString);
}

// f = 0, for methods that are made to see what they ask for.
class Nothing : public sensitivity::DesignFunction {
  double value(const std::vector<double>&, double) override { return 0.0; }
  std::vector<double> gradient(const std::vector<double>& design, double) override {
    return std::vector<double>(design.size(), 1.0);
  }
};

void askProjections(Teuchos::ParameterList& list) {
  Nothing nothing;
  const auto design = makeDesign({0.0}, {1.0}), derivative = makeDerivative({0.0}, {1.0});
  const auto number = makeNumber(0.0);
  const auto bounds = makeBounds({-1.0}, {1.0}, {1.0});
  const auto limit = ROL::makePtr<DesignLimit>(nothing);
  auto& type = list.sublist("General").sublist("Polyhedral Projection");
  for (const auto& name : methods(ROL::PPA_LAST, ROL::EPolyProjAlgoToString)) {
    type.set("Type", name);
    ROL::PolyhedralProjectionFactory<double>(*design, *derivative, bounds, limit, *number, *number, list);
  }
}

Teuchos::ParameterList askAll() {
  Teuchos::ParameterList list("ROL");
  auto& step = list.sublist("Step");
  for (const auto& type : methodsForBounds()) {
    step.set("Type", type);
    for (const std::string descent : {"Newton-Krylov", "Quasi-Newton Method", "Steepest Descent"})
      for (const std::string model : {"Lin-More", "Kelley-Sachs", "SPG"}) {
        step.sublist("Line Search").sublist("Descent Method").set("Type", descent);
        step.sublist("Trust Region").set("Subproblem Model", model);
        ROL::TypeB::AlgorithmFactory<double>(list);
      }
  }
  for (const auto& type : methodsForConstraints()) {
    step.set("Type", type);
    ROL::TypeG::AlgorithmFactory<double>(list);
  }
  askProjections(list);
  return list;
}

std::string joined(const std::string& place, const std::string& name) {
  return place.empty() ? name : place + "/" + name;
}

void refuseUnknown(const Teuchos::ParameterList& given, const Teuchos::ParameterList& known,
                   const std::string& place) {
  std::vector<std::string> names;
  for (const auto& entry : known)
    names.push_back(entry.first);
  for (const auto& entry : given) {
    const std::string path = joined(place, entry.first);
    if (!known.isParameter(entry.first))
      throw InputError("ROL has no parameter \"" + path + "\"" + offer(entry.first, names),
                       {{"parameter", path}});
    const auto& other = known.getEntry(entry.first);
    if (entry.second.isList() != other.isList())
      throw InputError("\"" + path + "\" is " + (other.isList() ? "a list" : "a value") + " of ROL",
                       {{"parameter", path}});
    if (entry.second.isList())
      refuseUnknown(given.sublist(entry.first), known.sublist(entry.first), path);
    else if (entry.second.getAny().type() != other.getAny().type() &&
             !(entry.second.isType<int>() && other.isType<double>()))
      throw InputError("\"" + path + "\" of ROL is of the type " + other.getAny().typeName() + ", not " +
                           entry.second.getAny().typeName(),
                       {{"parameter", path}});
  }
}

void putOver(Teuchos::ParameterList& result, const Teuchos::ParameterList& given,
             const Teuchos::ParameterList& known) {
  for (const auto& entry : given)
    if (entry.second.isList())
      putOver(result.sublist(entry.first), given.sublist(entry.first), known.sublist(entry.first));
    else if (entry.second.isType<int>() && known.getEntry(entry.first).isType<double>())
      result.set(entry.first, static_cast<double>(given.get<int>(entry.first)));
    else
      result.setEntry(entry.first, entry.second);
}

void refuseMethod(const std::string& type, const std::vector<std::string>& methods) {
  for (const auto& name : methods)
    if (ROL::removeStringFormat(name) == ROL::removeStringFormat(type))
      return;
  throw InputError("ROL has no method \"" + type + "\" (Step/Type) for this problem" + offer(type, methods),
                   {{"parameter", "Step/Type"}});
}

} // namespace

Teuchos::ParameterList defaultOptions(bool isNonlinear) {
  Teuchos::ParameterList list("ROL");
  auto& step = list.sublist("Step");
  step.set("Type", isNonlinear ? "Augmented Lagrangian" : "Trust Region");
  step.sublist("Line Search").sublist("Descent Method").set("Type", "Quasi-Newton Method");
  auto& secant = list.sublist("General").sublist("Secant");
  secant.set("Use as Hessian", true);
  secant.set("Maximum Storage", 60);
  list.sublist("General").sublist("Krylov").set("Iteration Limit", 60);
  auto& status = list.sublist("Status Test");
  status.set("Gradient Tolerance", 1e-3);
  status.set("Constraint Tolerance", 1e-6);
  status.set("Step Tolerance", 1e-6);
  status.set("Iteration Limit", 300);
  status.set("Use Relative Tolerances", true);
  return list;
}

const Teuchos::ParameterList& knownOptions() {
  static const Teuchos::ParameterList result = askAll();
  return result;
}

Teuchos::ParameterList completeOptions(const Teuchos::ParameterList& given, bool isNonlinear) {
  refuseUnknown(given, knownOptions(), "");
  Teuchos::ParameterList result = defaultOptions(isNonlinear);
  putOver(result, given, knownOptions());
  refuseMethod(result.sublist("Step").get<std::string>("Type"),
               isNonlinear ? methodsForConstraints() : methodsForBounds());
  return result;
}

} // namespace Harmos::rol
