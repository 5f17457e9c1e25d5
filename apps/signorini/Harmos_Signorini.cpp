// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Signorini.hpp"

#include "Harmos_ElasticSignorini.hpp"
#include "Harmos_Membranes.hpp"

namespace {

using namespace Harmos;

std::string problemOf(const Teuchos::ParameterList& deck) {
  return deck.sublist("Model").get<std::string>("Problem");
}

void addParameters(ParameterSpec& deck) {
  ParameterSpec model("Model", "Problem, geometry and discretisation.");
  model.choice(
      "Problem", "membranes",
      {{"membranes", "two membranes in contact: the model problem of Dostál, Horák, Vlach"},
       {"block", "a heavy elastic square or cube on a rigid plane, lifted at one side"},
       {"hertz cylinder", "an elastic cylinder between rigid plates, a quarter of its cross-section"},
       {"hertz ball", "an elastic ball between rigid plates, an eighth of it"}},
      "Model problem.");
  model.integer("Subdomains per side", 4, 1, 1024, "1/H: number of subdomains along the side of a body.");
  model.integer("Elements per subdomain side", 8, 1, 4096,
                "H/h: number of elements along the side of a subdomain.");
  model.choice("Interface", "contact",
               {{"contact", "the second membrane lies on or above the first one: u² − u¹ ≥ 0"},
                {"tie", "the membranes are tied: u² = u¹"}},
               "Membranes: condition at x = 1.");
  model.integer("Element order", 1, 1, 2, "Elastic bodies: 1 for Q1, 2 for Q2 elements.");
  model.integer("Dimension", 2, 2, 3, "Block: 2, a square in plane strain, or 3, a cube.");
  model.real("Weight", 0.01, Range::above(0.0), "Block: force per volume.");
  model.real("Approach", 0.002, Range::above(0.0),
             "Hertz: displacement of the middle plane towards the plate, in radii.");
  deck.list(std::move(model));
  ParameterSpec material("Material", "Isotropic material of elastic bodies.");
  material.real("Young's modulus", 1.0, Range::above(0.0),
                "Young's modulus, force per area in units of your choice.");
  material.real("Poisson's ratio", 0.3, Range::strictlyWithin(-1.0, 0.5),
                "Ratio of lateral contraction to extension.");
  deck.list(std::move(material));
}

scene::Scene makeScene(const app::DeckContext& context) {
  const std::string problem = problemOf(context.deck);
  if (problem == "block")
    return signorini::block(context.deck);
  if (problem == "hertz cylinder" || problem == "hertz ball")
    return signorini::hertz(context.deck, problem == "hertz ball");
  return signorini::membranes(context.deck.sublist("Model"));
}

void evaluate(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck, run::RunReport& report) {
  const std::string problem = problemOf(deck);
  if (problem == "hertz cylinder" || problem == "hertz ball")
    signorini::evaluateHertz(comm, deck, problem == "hertz ball", report);
}

} // namespace

Harmos::app::Application Harmos::app::signoriniApplication() {
  return {"signorini",   "Signorini problems: membranes in contact, elastic bodies on a plane",
          addParameters, makeScene,
          evaluate,      nullptr};
}
