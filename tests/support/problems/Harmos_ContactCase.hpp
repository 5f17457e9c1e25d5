// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_Functional.hpp"
#include "Harmos_ShapeModel.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace Harmos {

/// A scene with its solver, as an application that changes designs has it.
struct ContactCase {
  scene::Scene scene;
  std::vector<scene::OwnedSubdomain> owned;
  scene::ContactSetup contact;
  std::unique_ptr<feti::FetiSolver> solver;

  /// @param moves whether nodes are to be moved.
  ContactCase(scene::Scene what, const Teuchos::ParameterList& list, bool moves = false,
              const Teuchos::RCP<const Teuchos::Comm<int>>& comm = testComm())
      : scene(std::move(what)) {
    owned = scene::decompose(*comm, scene);
    contact = scene::setUpContact(*comm, scene, owned);
    if (moves)
      sensitivity::completeRows(contact, scene.components());
    solver = std::make_unique<feti::FetiSolver>(comm, scene::assemble(scene, owned), contact.rows, list);
  }
  sensitivity::RowGeometry geometry() const { return sensitivity::geometryOf(contact, scene); }
  /// The place of the first effect of a kind.
  int effect(const std::string& kind) const {
    for (std::size_t e = 0; e < scene.effects.size(); ++e)
      if (scene.effects[e]->kind() == kind)
        return static_cast<int>(e);
    return -1;
  }
};

/// @param dirichlet "primal" or "dual".
inline Teuchos::ParameterList contactCaseParameters(double tolerance,
                                                    const std::string& dirichlet = "primal") {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", tolerance);
  list.sublist("Decomposition").set("Dirichlet", dirichlet);
  return list;
}

/// Two blocks on top of each other, or one on a rigid plane: an upper one pressed down by a pressure that
/// varies, all of it held sideways at the left (and in front), the lower one at the bottom.
/// @param gap between them, everywhere.
inline scene::Scene pressedBlocks(bool isSpace, bool onPlane, int elements, double gap = 0.0) {
  using fem::Point;
  const int up = isSpace ? 2 : 1;
  scene::Scene scene;
  scene.physics = isSpace ? scene::Physics::Solid : scene::Physics::PlaneStrain;
  fem::StructuredBlock::Options options;
  options.cellType = isSpace ? fem::CellType::Hexahedron8 : fem::CellType::Quadrilateral4;
  options.subdomains = {2, isSpace ? 1 : 2, 1};
  options.elements = {elements, elements, elements};
  options.size = {2.0, 1.0, 1.0};
  if (!onPlane)
    scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(2.0, 0.3)));
  options.origin[static_cast<std::size_t>(up)] = 1.0;
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.25)));
  const int upper = static_cast<int>(scene.bodies.size()) - 1;
  for (int body = 0; body <= upper; ++body) {
    prescribe(scene, {body, "left"}, 0);
    if (isSpace)
      prescribe(scene, {body, "front"}, 1);
  }
  addTraction(scene, {upper, "top"}, [up](const Point& x, const Point&) {
    Point t{};
    t[static_cast<std::size_t>(up)] = -0.05 * (1.0 + 0.6 * std::sin(2.0 * x[0]) + 0.2 * x[1]);
    t[0] = 0.003 * x[0];
    return t;
  });
  if (onPlane) {
    contact::Obstacle plane;
    plane.shape = contact::Obstacle::Shape::HalfSpace;
    plane.point[static_cast<std::size_t>(up)] = 1.0 - gap;
    plane.direction[static_cast<std::size_t>(up)] = 1.0;
    addObstacle(scene, {upper, "bottom"}, plane);
  } else {
    prescribe(scene, {0, "bottom"}, up);
    addContact(scene, {0, "top"}, {1, "bottom"}, gap);
  }
  return scene;
}

/// A number between −1 and 1 that is the same everywhere.
inline double pseudoRandom(int seed, std::size_t k) {
  const double x =
      std::sin(12.9898 * static_cast<double>(seed + 1) + 78.233 * static_cast<double>(k + 1)) * 43758.5453;
  return 2.0 * (x - std::floor(x)) - 1.0;
}

} // namespace Harmos
