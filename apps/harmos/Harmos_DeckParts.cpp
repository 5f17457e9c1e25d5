// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeckParts.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::app {
namespace {

using Teuchos::ParameterList;

constexpr double usualAngle = 30.0;

InputError fault(const std::string& path, const std::string& what) {
  return InputError("\"" + path + "\" " + what, {{"path", path}});
}

// A rule's list, with its path for messages.
struct RuleList {
  const ParameterList& list;
  std::string path;

  std::vector<std::string> texts(const std::string& name) const {
    const auto& array = list.get<Teuchos::Array<std::string>>(name);
    return {array.begin(), array.end()};
  }
  // None if it is not given.
  std::optional<fem::Point> point(const std::string& name) const {
    const auto& array = list.get<Teuchos::Array<double>>(name);
    if (array.empty())
      return std::nullopt;
    if (array.size() != 3)
      throw fault(path + "/" + name,
                  "has " + std::to_string(array.size()) + " numbers; points and directions have three");
    return fem::Point{array[0], array[1], array[2]};
  }
  std::optional<fem::Point> direction(const std::string& name) const {
    const std::optional<fem::Point> x = point(name);
    if (x && norm(*x) == 0.0)
      throw fault(path + "/" + name, "is a zero vector; give a nonzero direction");
    return x;
  }
  // Two that make sense together alone.
  void requireBoth(bool first, const std::string& firstName, bool second,
                   const std::string& secondName) const {
    if (first != second)
      throw fault(path + "/" + (first ? firstName : secondName),
                  "is given without \"" + (first ? secondName : firstName) + "\"; give both or none");
  }
};

fem::BoundaryRule ruleFrom(const RuleList& given, const std::string& name) {
  fem::BoundaryRule rule;
  rule.name = name;
  rule.bodies = given.texts("Bodies");
  rule.of = given.texts("Of");
  const auto low = given.point("Box from"), high = given.point("Box to");
  if (low || high) {
    constexpr double far = std::numeric_limits<double>::infinity();
    rule.box = fem::Box{low.value_or(fem::Point{-far, -far, -far}), high.value_or(fem::Point{far, far, far})};
    for (std::size_t d = 0; d < 3; ++d)
      if (rule.box->low[d] > rule.box->high[d])
        throw fault(given.path + "/Box from", "lies beyond \"Box to\"; swap them");
  }
  const double angle = given.list.get<double>("Angle");
  if (const auto normal = given.direction("Normal"))
    rule.direction = fem::BoundaryRule::Direction{*normal, angle};
  else if (angle != usualAngle)
    throw fault(given.path + "/Angle", "is given without \"Normal\", its reference direction");
  const auto planePoint = given.point("Plane point"), planeNormal = given.direction("Plane normal");
  given.requireBoth(planePoint.has_value(), "Plane point", planeNormal.has_value(), "Plane normal");
  if (planePoint)
    rule.plane = fem::BoundaryRule::Plane{*planePoint, *planeNormal};
  const auto centre = given.point("Cylinder point");
  const double radius = given.list.get<double>("Cylinder radius");
  given.requireBoth(centre.has_value(), "Cylinder point", radius > 0.0, "Cylinder radius");
  if (!centre && given.direction("Cylinder axis"))
    throw fault(given.path + "/Cylinder axis", "is given without \"Cylinder point\" and \"Cylinder radius\"");
  if (centre)
    rule.cylinder = fem::BoundaryRule::Cylinder{
        *centre, given.direction("Cylinder axis").value_or(fem::Point{0.0, 0.0, 1.0}), radius};
  const RuleList expert = {given.list.sublist("Expert"), given.path + "/Expert"};
  const std::vector<std::string> faced = expert.texts("Facing");
  const double distance = expert.list.get<double>("Distance");
  if (!faced.empty())
    rule.facing = fem::BoundaryRule::Facing{faced, distance};
  else if (distance > 0.0)
    throw fault(expert.path + "/Distance", "is given without \"Facing\", the bodies that are to be near");
  if (const auto facets = expert.list.get<std::string>("Facets"); facets != "all")
    rule.corners = facets == "triangles" ? 3 : 4;
  rule.tolerance = expert.list.get<double>("Tolerance");
  return rule;
}

} // namespace

void addPartParameters(ParameterSpec& deck) {
  ParameterSpec part("<part>", "Sides on the boundary, by a name of your choice. A part has the sides of "
                               "cells on the boundary that meet all conditions given here.");
  part.texts("Bodies", {}, "Bodies with this part; none: each body that has such sides.");
  part.texts("Of", {},
             "Parts of the mesh, or of rules before this one, from which sides are selected; none: the whole "
             "boundary.");
  part.series("Box from", Range(), "Corner of a box along the axes that contains all of a side.");
  part.series("Box to", Range(), "Opposite corner. Without one of the two the box is unbounded there.");
  part.series("Normal", Range(), "Direction of the outward normal, within \"Angle\".");
  part.real("Angle", usualAngle, Range::within(0.0, 180.0), "Largest angle to \"Normal\", in degrees.");
  part.series("Plane point", Range(), "Point of a plane that contains the sides.");
  part.series("Plane normal", Range(), "Normal of the plane, in either direction.");
  part.series("Cylinder point", Range(), "Point on the axis of a cylinder that contains the sides.");
  part.series("Cylinder axis", Range(), "Direction of the axis; none: z.");
  part.real("Cylinder radius", 0.0, Range::atLeast(0.0), "Radius of the cylinder; 0: no cylinder.");
  part.expert().choice(
      "Facets", "all",
      {{"all", "of any shape"}, {"triangles", "with three corners"}, {"quadrilaterals", "with four corners"}},
      "In space: shape of the sides. A surface in contact has one.");
  part.expert().texts("Facing", {},
                      "Bodies that the sides face: within \"Distance\", with opposite normals.");
  part.expert().real(
      "Distance", 0.0, Range::atLeast(0.0),
      "Largest distance to \"Facing\", a length; 0: a twentieth of the diagonal of the smaller body.");
  part.expert().real("Tolerance", 1e-5, Range::within(0.0, 1.0),
                     "Tolerance of box, plane and cylinder, as a share of the diagonal of the box around the "
                     "body.");
  ParameterSpec parts("Boundary parts", "Boundary parts in addition to those of the meshes.");
  parts.family(std::move(part));
  deck.list(std::move(parts));
}

void addBoundaryRules(const ParameterList& deck, scene::Scene& scene) {
  std::vector<std::string> bodies;
  for (const scene::Body& body : scene.bodies)
    bodies.push_back(body.name);
  const ParameterList& parts = deck.sublist("Boundary parts");
  for (auto item = parts.begin(); item != parts.end(); ++item) {
    const std::string& name = parts.name(item);
    const std::string path = "Boundary parts/" + name;
    const auto isOdd = [](unsigned char sign) { return sign == '/' || sign < ' '; };
    if (name.empty() || std::any_of(name.begin(), name.end(), isOdd))
      throw fault("Boundary parts",
                  "has a part \"" + name +
                      "\" whose name is empty or contains a slash or a line break; use another name");
    scene.boundaryRules.push_back(ruleFrom({parts.sublist(name), path}, name));
    const fem::BoundaryRule& rule = scene.boundaryRules.back();
    const auto requireBodies = [&](const std::vector<std::string>& named, const std::string& parameter) {
      for (const std::string& body : named)
        if (std::find(bodies.begin(), bodies.end(), body) == bodies.end())
          throw fault(path + "/" + parameter,
                      "names the body \"" + body + "\", which does not exist" + offer(body, bodies));
    };
    requireBodies(rule.bodies, "Bodies");
    if (rule.facing)
      requireBodies(rule.facing->bodies, "Expert/Facing");
  }
}

} // namespace Harmos::app
