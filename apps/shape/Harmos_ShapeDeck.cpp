// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeDeck.hpp"

#include "Harmos_DeckPlaces.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_NearestName.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::shape {
namespace {

void addDesign(ParameterSpec& shape) {
  ParameterSpec design("Design", "Design variables: the numbers that the optimiser chooses.");
  design.choice(
      "Kind", "gap",
      {{"gap",
        "the gaps of contacts and obstacles: a profile on a surface that is nearly flat; no matrix changes"},
       {"position", "the nodes of a body near a boundary part; those inside follow smoothly"}},
      "Quantity that is designed.");
  design.texts(
      "Contacts", {},
      "Kind \"gap\": contacts and obstacles with a designed gap; none: all. Named as in \"Contact/joint\".");
  design.choice("Functions", "nodes",
                {{"nodes", "a number for each contact point"}, {"splines", "B-splines along axes"}},
                "Kind \"gap\": basis of the profile. The kind \"position\" always has splines.");
  design.texts("Axes", {},
               "Splines: x, y or z, or two of them. None: those along which the surface extends, one in the "
               "plane.");
  design.integers("Pieces", {8, 8}, 1, 10000,
                  "Splines: number of equal pieces along the first and the second axis.");
  design.integer("Degree", 2, 0, 3,
                 "Splines: degree, 0 constant, 1 linear, 2 and 3 smooth. The sum of pieces and degree is the "
                 "number of variables along an axis.");
  design.series("Start", Range(), "Start values: one for all variables, or one each; none: 0.");
  design.series("Lower", Range(), "Lower bounds: one for all variables, or one each; none: no bound.");
  design.series("Upper", Range(), "Upper bounds: one for all variables, or one each; none: no bound.");
  design.text("Surface", "", "Kind \"position\": \"body/boundary part\" whose nodes are designed.");
  design.texts("Bodies", {},
               "Kind \"position\": bodies whose nodes follow; none: that of the surface. Bodies in contact "
               "with matching nodes must both follow.");
  design.reals("Direction", {0.0, 1.0, 0.0}, Range(),
               "Kind \"position\": direction of the movement, the surface's outward normal.");
  design.real("Depth", 0.0, Range::atLeast(0.0),
              "Kind \"position\": depth to which nodes follow, a length; 0: all of the bodies.");
  design.expert().real(
      "Least quality", 0.2, Range::strictlyWithin(0.0, 1.0),
      "Kind \"position\": least quality of a cell, relative to its initial shape (1: similar, "
      "0: tangled). Designs with a lower one are rejected.");
  shape.list(std::move(design));
}

void addCost(ParameterSpec& shape) {
  ParameterSpec cost("Cost", "Quantity that the optimiser minimises.");
  cost.choice(
      "Quantity", "peak pressure",
      {{"peak pressure", "the norm (Σ a pᵖ/Σ a)^(1/p) of the contact pressure, near its peak for large p"},
       {"pressure spread", "the square of the pressure's coefficient of variation"},
       {"softest", "the least potential energy J = min ½uᵀKu − fᵀu: largest displacement under the loads"},
       {"stiffest",
        "−J: least displacement under the loads. J is convex in gaps and −J is not: the result is a local "
        "minimum"},
       {"displacement", "the mean displacement of a boundary part along a direction"}},
      "Cost.");
  cost.real("Exponent", 8.0, Range::above(1.0), "Quantity \"peak pressure\": p.");
  cost.texts("Contacts", {},
             "Contacts and obstacles of the pressure; none: those that are designed, or all. The results "
             "tell peak and mean of their pressure.");
  cost.text("Part", "", "Quantity \"displacement\": \"body/boundary part\".");
  cost.reals("Direction", {0.0, 1.0, 0.0}, Range(),
             "Quantity \"displacement\": its direction; the opposite one maximises.");
  shape.list(std::move(cost));
}

} // namespace

void ShapeDeck::addTo(ParameterSpec& deck) {
  ParameterSpec shape("Shape", "Optimal shape of a contact surface.");
  addDesign(shape);
  addCost(shape);
  ParameterSpec constraints("Constraints", "Constraints of a design, in addition to bounds.");
  constraints.series("Volume", Range(),
                     "Added volume: its value, or the least and the largest; none: no constraint. The volume "
                     "that a design adds to the gaps, ∫ profile, or to the bodies; in the plane an area.");
  shape.list(std::move(constraints));
  ParameterSpec limits("Limits", "Limits of an optimisation; --restart continues it.");
  limits.integer("Evaluations", 0, 0, 1000000000,
                 "Largest number of solves for costs, of the whole optimisation; 0: no limit.");
  limits.real("Seconds", 0.0, Range::atLeast(0.0), "Time limit of this run in seconds; 0: no limit.");
  shape.list(std::move(limits));
  shape.foreign("Optimiser",
                "Parameters of ROL. They replace the defaults of Harmos: \"Status Test\", \"Step\", "
                "\"General\", as in ROL's documentation.");
  deck.list(std::move(shape));
}

namespace {

std::vector<std::string> textsIn(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& array = list.get<Teuchos::Array<std::string>>(name);
  return {array.begin(), array.end()};
}

std::vector<double> numbersIn(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& array = list.get<Teuchos::Array<double>>(name);
  return {array.begin(), array.end()};
}

// Contacts and obstacles by their paths.
std::set<int> surfacesIn(const scene::Scene& scene, const Teuchos::ParameterList& list,
                         const std::string& path) {
  const std::vector<std::string> paths = scene.effectPaths();
  std::vector<std::string> known;
  std::set<int> all, chosen;
  for (std::size_t e = 0; e < scene.effects.size(); ++e)
    if (scene.effects[e]->givesInequalities()) {
      known.push_back(paths[e]);
      all.insert(static_cast<int>(e));
    }
  for (const std::string& name : textsIn(list, "Contacts")) {
    const auto found = std::find(paths.begin(), paths.end(), name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError("\"" + path + "/Contacts\" names \"" + name +
                           "\", which is not a contact or obstacle of the scene" + offer(name, known),
                       {{"path", path + "/Contacts"}});
    chosen.insert(static_cast<int>(found - paths.begin()));
  }
  return chosen.empty() ? all : chosen;
}

fem::Point directionIn(const Teuchos::ParameterList& list, const std::string& path) {
  const fem::Point direction = effects::pointIn(list, "Direction");
  if (!(std::hypot(direction[0], direction[1], direction[2]) > 0.0))
    throw InputError("\"" + path + "/Direction\" is a zero vector; give a nonzero vector",
                     {{"path", path + "/Direction"}});
  return direction;
}

void readDesign(const Teuchos::ParameterList& list, const scene::Scene& scene, ShapeDeck& deck) {
  const std::string path = "Shape/Design";
  deck.kind = list.get<std::string>("Kind") == "gap" ? ShapeDeck::Kind::Gap : ShapeDeck::Kind::Position;
  deck.surfaces = surfacesIn(scene, list, path);
  deck.byNodes = list.get<std::string>("Functions") == "nodes" && deck.kind == ShapeDeck::Kind::Gap;
  for (const std::string& axis : textsIn(list, "Axes")) {
    if (axis != "x" && axis != "y" && axis != "z")
      throw InputError("\"" + path + "/Axes\" names \"" + axis + "\"; name x, y or z",
                       {{"path", path + "/Axes"}});
    deck.axes.push_back(axis[0] - 'x');
  }
  const auto& pieces = list.get<Teuchos::Array<int>>("Pieces");
  deck.pieces = {pieces.begin(), pieces.end()};
  deck.degree = list.get<int>("Degree");
  deck.start = numbersIn(list, "Start");
  deck.lower = numbersIn(list, "Lower");
  deck.upper = numbersIn(list, "Upper");
  if (deck.kind == ShapeDeck::Kind::Gap)
    return;
  const effects::Part part = effects::partIn(scene, list, "Surface", path);
  deck.body = part.body;
  deck.part = part.set;
  deck.bodies = {part.body};
  for (const std::string& name : textsIn(list, "Bodies")) {
    Teuchos::ParameterList one;
    one.set("Bodies", name);
    deck.bodies.insert(effects::bodyIn(scene, one, "Bodies", path));
  }
  deck.direction = directionIn(list, path);
  deck.depth = list.get<double>("Depth");
  deck.leastQuality = list.sublist("Expert").get<double>("Least quality");
}

void readCost(const Teuchos::ParameterList& list, const scene::Scene& scene, ShapeDeck& deck) {
  const std::string path = "Shape/Cost";
  deck.quantity = list.get<std::string>("Quantity");
  deck.sign = deck.quantity == "stiffest" ? -1.0 : 1.0;
  deck.exponent = list.get<double>("Exponent");
  deck.pressed = textsIn(list, "Contacts").empty() && deck.kind == ShapeDeck::Kind::Gap
                     ? deck.surfaces
                     : surfacesIn(scene, list, path);
  if (deck.quantity != "displacement")
    return;
  const effects::Part part = effects::partIn(scene, list, "Part", path);
  deck.displacedBody = part.body;
  deck.displacedPart = part.set;
  deck.displacedDirection = directionIn(list, path);
}

} // namespace

ShapeDeck ShapeDeck::fromDeck(const Teuchos::ParameterList& deck, const scene::Scene& scene) {
  const Teuchos::ParameterList& list = deck.sublist("Shape");
  if (scene.goesInSteps())
    throw InputError("a shape is designed for one static state; remove \"Steps\" and adhesion from the deck");
  if (!scene.hasInequalities())
    throw InputError(
        "the scene has no contact surface to design; add \"Effects/Contact\" or \"Effects/Obstacle\"");
  ShapeDeck result;
  readDesign(list.sublist("Design"), scene, result);
  readCost(list.sublist("Cost"), scene, result);
  result.volume = numbersIn(list.sublist("Constraints"), "Volume");
  if (result.volume.size() > 2 || (result.volume.size() == 2 && result.volume[0] > result.volume[1]))
    throw InputError("\"Shape/Constraints/Volume\" needs one value or a minimum and a maximum",
                     {{"path", "Shape/Constraints/Volume"}});
  result.mostEvaluations = list.sublist("Limits").get<int>("Evaluations");
  result.mostSeconds = list.sublist("Limits").get<double>("Seconds");
  result.optimiser = list.sublist("Optimiser");
  return result;
}

void ShapeDeck::checkParts(const scene::Scene& scene, const scene::PartNames& names) const {
  const auto check = [&](int number, const std::string& name, const std::string& path) {
    const auto place = static_cast<std::size_t>(number);
    if (const std::set<std::string>& known = names.all[place]; known.count(name) == 0)
      throw InputError("\"" + path + "\" names the boundary part \"" + name + "\", which the body \"" +
                           scene.bodies[place].name + "\" does not have" +
                           offer(name, {known.begin(), known.end()}),
                       {{"path", path}});
  };
  if (kind == Kind::Position)
    check(body, part, "Shape/Design/Surface");
  if (quantity == "displacement")
    check(displacedBody, displacedPart, "Shape/Cost/Part");
}

sensitivity::TensorSplineBasis ShapeDeck::basis(const scene::Scene& scene, const fem::Point& low,
                                                const fem::Point& high) const {
  const bool isSpace = scene.physics == scene::Physics::Solid;
  std::vector<int> chosen = axes;
  if (chosen.empty()) { // the longest, and in space the next one where it is more than rounding
    std::vector<int> order = {0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      const auto extent = [&](int axis) {
        return high[static_cast<std::size_t>(axis)] - low[static_cast<std::size_t>(axis)];
      };
      return extent(a) > extent(b);
    });
    order.resize(isSpace ? 2 : 1);
    std::sort(order.begin(), order.end());
    chosen = order;
  }
  if (chosen.size() > 2)
    throw InputError("\"Shape/Design/Axes\" names three axes; give one or two",
                     {{"path", "Shape/Design/Axes"}});
  std::vector<sensitivity::SplineBasis> bases;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto axis = static_cast<std::size_t>(chosen[k]);
    const double size = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
    constexpr double rounding = 1e-9;
    if (!(high[axis] - low[axis] > rounding * size))
      throw InputError(std::string("the surface does not extend along ") + "xyz"[axis] +
                           ", along which \"Shape/Design/Axes\" has splines",
                       {{"path", "Shape/Design/Axes"}});
    bases.push_back(sensitivity::SplineBasis::uniform(degree, low[axis], high[axis], pieces[k]));
  }
  return {std::move(bases), chosen};
}

sensitivity::DesignSpace ShapeDeck::space(const std::vector<double>& weights) const {
  const auto spread = [&](const std::vector<double>& given, double none, const std::string& name) {
    if (given.size() > 1 && given.size() != weights.size())
      throw InputError("\"Shape/Design/" + name + "\" has " + std::to_string(given.size()) +
                           " numbers, but the design " + std::to_string(weights.size()) +
                           "; give one for all or one each",
                       {{"path", "Shape/Design/" + name}});
    return given.size() == weights.size()
               ? given
               : std::vector<double>(weights.size(), given.empty() ? none : given.front());
  };
  constexpr double far = std::numeric_limits<double>::infinity();
  sensitivity::DesignSpace space = {spread(start, 0.0, "Start"), spread(lower, -far, "Lower"),
                                    spread(upper, far, "Upper"), weights};
  space.check();
  return space;
}

} // namespace Harmos::shape
