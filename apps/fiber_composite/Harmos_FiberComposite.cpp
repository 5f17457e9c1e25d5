// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FiberComposite.hpp"

#include "Harmos_Adhesion.hpp"
#include "Harmos_Composite.hpp"
#include "Harmos_Exchange.hpp"

#include <cmath>

namespace {

using namespace Harmos;
using composite::Sample;

void addMaterial(ParameterSpec& deck, const std::string& name, const std::string& meaning, double young) {
  ParameterSpec material(name, meaning);
  material.real("Young's modulus", young, Range::above(0.0),
                "Young's modulus, force per area in units of your choice.");
  material.real("Poisson's ratio", 0.3, Range::strictlyWithin(-1.0, 0.5),
                "Ratio of lateral contraction to extension.");
  deck.list(std::move(material));
}

void addExpertParameters(ParameterSpec& expert) {
  expert.integer("Fibre layers", 3, 1, 1000, "Layers of elements around the core of a fibre.");
  expert.integer("Matrix layers", 4, 1, 1000,
                 "Layers of elements between the fibre and the side of the cell.");
  expert.integer("Subdomains per fibre", 1, 1, 10000, "Subdomains of a fibre; more than one: by METIS.");
  expert.integer("Subdomains per matrix cell", 1, 1, 10000,
                 "Subdomains of the matrix of a cell; more than one: by METIS.");
  expert.choice("Dilatation", "auto",
                {{"auto", "projected if Poisson's ratio is above 0.4"},
                 {"full", "from the displacements"},
                 {"projected", "B-bar, for nearly incompressible materials"}},
                "Volume change in the stiffness.");
}

void addParameters(ParameterSpec& deck) {
  ParameterSpec model("Model", "Geometry and discretisation of the sample.");
  model.integer("Columns", 4, 1, 10000, "Number of cells along x.");
  model.integer("Rows", 4, 1, 10000, "Number of cells along y.");
  model.real("Cell size", 1.0, Range::above(0.0), "Side of a cell, a length.");
  model.real("Volume fraction", 0.4, Range::within(0.01, 0.7),
             "Volume fraction of the fibres, which gives their radius.");
  model.integer("Elements per side", 5, 2, 1000,
                "Elements along a side of a cell. There are four times as many around a fibre.");
  model.integer("Element order", 1, 1, 2, "1: bilinear quadrilaterals; 2: biquadratic ones, curved.");
  model.real("Radius scatter", 0.0, Range::within(0.0, 0.9),
             "Largest relative deviation of radii, uniformly distributed.");
  model.real("Offset scatter", 0.0, Range::within(0.0, 0.5),
             "Largest offset of centres along each axis, uniformly distributed, in sides of a cell.");
  model.integer("Seed", 1, 0, 2147483647, "Seed of the scatter.");
  model.choice("Interface", "contact",
               {{"contact", "fibres inserted without adhesion: unilateral contact all around"},
                {"adhesive",
                 "fibres glued to the matrix until the adhesive breaks, see the list Adhesion; then contact"},
                {"tie", "fibres bonded to the matrix"},
                {"holes", "no fibres"},
                {"homogeneous", "bonded fibres of the material of the matrix"}},
               "Condition between fibre and matrix.");
  model.real("Slip bound", 0.0, Range::atLeast(0.0),
             "Contact, adhesive: bound of Tresca's friction, force per area; 0: none.");
  model.real("Coefficient of friction", 0.0, Range::atLeast(0.0),
             "Contact, adhesive: coefficient of Coulomb's friction, bound over pressure; 0: none.");
  ParameterSpec adhesion("Adhesion", "Interface adhesive: springs around each fibre, and their damage.");
  effects::addCohesiveLaw(adhesion);
  model.list(std::move(adhesion));
  model.choice("Load", "stretch",
               {{"stretch", "the right side moves to the right"},
                {"compression", "the right side moves to the left"},
                {"biaxial", "the right side moves to the right and the top upward"}},
               "Prescribed displacements. The left side is held in x, the bottom in y; others are free.");
  model.real("Strain", 0.01, Range::above(0.0), "Displacement of a side over the length of the sample.");
  model.text("History", "",
             "Name of one of \"Steps/Histories\", the factor of the displacement; empty: ramp.");
  model.choice(
      "Physics", "plane strain",
      {{"plane strain", "no strain out of the plane"}, {"plane stress", "no stress out of the plane"}},
      "State of the cross-section.");
  addExpertParameters(model.expert());
  deck.list(std::move(model));
  ParameterSpec materials("Materials", "Isotropic, linear elastic materials.");
  addMaterial(materials, "Matrix", "Material of the matrix.", 1.0);
  addMaterial(materials, "Fibre", "Material of the fibres.", 10.0);
  deck.list(std::move(materials));
}

fem::Material material(const Teuchos::ParameterList& list) {
  return fem::Material::isotropic(list.get<double>("Young's modulus"), list.get<double>("Poisson's ratio"));
}

Sample sampleOf(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList& model = deck.sublist("Model");
  const Teuchos::ParameterList& expert = model.sublist("Expert");
  Sample sample;
  sample.columns = model.get<int>("Columns");
  sample.rows = model.get<int>("Rows");
  sample.cell.size = model.get<double>("Cell size");
  sample.cell.radius = sample.cell.size * std::sqrt(model.get<double>("Volume fraction") / std::acos(-1.0));
  sample.cell.elementsPerSide = model.get<int>("Elements per side");
  sample.cell.fibreLayers = expert.get<int>("Fibre layers");
  sample.cell.matrixLayers = expert.get<int>("Matrix layers");
  sample.cell.cellType =
      model.get<int>("Element order") == 1 ? fem::CellType::Quadrilateral4 : fem::CellType::Quadrilateral9;
  sample.radiusScatter = model.get<double>("Radius scatter");
  sample.offsetScatter = model.get<double>("Offset scatter");
  sample.seed = model.get<int>("Seed");
  sample.fibreSubdomains = expert.get<int>("Subdomains per fibre");
  sample.matrixSubdomains = expert.get<int>("Subdomains per matrix cell");
  const std::string interface = model.get<std::string>("Interface"), load = model.get<std::string>("Load");
  sample.interface = interface == "contact"    ? Sample::Interface::Contact
                     : interface == "adhesive" ? Sample::Interface::Adhesive
                     : interface == "tie"      ? Sample::Interface::Tie
                     : interface == "holes"    ? Sample::Interface::Holes
                                               : Sample::Interface::Homogeneous;
  if (sample.interface == Sample::Interface::Adhesive)
    sample.adhesion = effects::cohesiveLawFrom(model.sublist("Adhesion"), "Model/Adhesion");
  sample.slipBound = model.get<double>("Slip bound");
  sample.frictionCoefficient = model.get<double>("Coefficient of friction");
  if (sample.slipBound > 0.0 && sample.frictionCoefficient > 0.0)
    throw InputError("\"Model/Slip bound\" and \"Model/Coefficient of friction\" are two laws of friction; "
                     "give one of them",
                     {{"path", "Model/Slip bound"}});
  sample.load = load == "stretch"       ? Sample::Load::Stretch
                : load == "compression" ? Sample::Load::Compression
                                        : Sample::Load::Biaxial;
  sample.strain = model.get<double>("Strain");
  sample.history = model.get<std::string>("History");
  sample.physics = model.get<std::string>("Physics") == "plane stress" ? scene::Physics::PlaneStress
                                                                       : scene::Physics::PlaneStrain;
  sample.dilatation = expert.get<std::string>("Dilatation");
  sample.matrix = material(deck.sublist("Materials").sublist("Matrix"));
  sample.fibre = material(deck.sublist("Materials").sublist("Fibre"));
  return sample;
}

scene::Scene makeScene(const app::DeckContext& context) {
  return composite::makeScene(sampleOf(context.deck));
}

// With displacements prescribed on the sides alone and contact without initial gap, and springs that are
// unstretched at the beginning, the problem is homogeneous of degree two: force times displacement = twice
// the energy. With friction that is twice the stored energy and what is dissipated, which the audit's energy
// has in it.
void evaluate(const Teuchos::Comm<int>& comm, const Teuchos::ParameterList& deck, run::RunReport& report) {
  const Sample sample = sampleOf(deck);
  const scene::Timeline timeline = scene::Timeline::fromDeck(deck);
  const double strain =
      sample.strain * timeline.factor(sample.history.empty() ? "ramp" : sample.history, timeline.end());
  if (strain != 0.0)
    report.results["effective_modulus"] =
        (2.0 * report.audit.energy - report.audit.frictionWork) / (strain * strain * sample.area());
  const run::ContactCounts& counts = report.contactCounts;
  if (counts.points == 0)
    return;
  double largest = 0.0;
  for (const run::ContactState& state : report.contact)
    largest = std::max(largest, state.pressure);
  report.results["closed_fraction"] = static_cast<double>(counts.closed) / static_cast<double>(counts.points);
  report.results["largest_contact_pressure"] = globalMax(comm, largest);
}

} // namespace

Harmos::app::Application Harmos::app::fiberCompositeApplication() {
  app::Application application;
  application.name = "fiber_composite";
  application.description = "a fibre composite: contact, glue or ties between fibres and matrix";
  application.addParameters = addParameters;
  application.makeScene = makeScene;
  application.evaluate = evaluate;
  return application;
}
