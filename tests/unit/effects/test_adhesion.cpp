// SPDX-License-Identifier: BSD-3-Clause

/// Adhesion that makes no sense is refused, with the reason; which points it binds, and by which rows; what
/// they become where points break, and where friction takes over.

#include "Harmos_Adhesion.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_EffectStates.hpp"
#include "Harmos_Effects.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_RigidObstacle.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace test_adhesion {

using namespace Harmos;
using effects::CohesiveLaw;

namespace {

CohesiveLaw brittle() {
  CohesiveLaw::Options options;
  options.kind = CohesiveLaw::Kind::Brittle;
  options.normalStiffness = 20.0;
  options.tangentialStiffness = 40.0;
  options.normalStrength = options.tangentialStrength = 1.0;
  return CohesiveLaw(options);
}

// A lower block and an upper one, which is so much narrower that its side is inside, and bent upwards.
scene::Scene blocks(scene::Physics physics = scene::Physics::PlaneStrain, bool doesMatch = true,
                    double bend = 0.0) {
  scene::Scene scene;
  scene.physics = physics;
  const bool inSpace = physics == scene::Physics::Solid;
  fem::StructuredBlock::Options options;
  if (inSpace)
    options.cellType = fem::CellType::Hexahedron8;
  options.subdomains = {2, 1, 1};
  options.elements = {2, 2, inSpace ? 2 : 1};
  scene.bodies.push_back(blockBody("lower", options, fem::Material::isotropic(1.0, 0.3)));
  options.origin[inSpace ? 2 : 1] = 1.0;
  if (!doesMatch)
    options.elements = {3, 2, inSpace ? 3 : 1};
  if (bend > 0.0)
    options.map = [bend](fem::Point x) {
      x[1] += x[0] > 0.6 ? bend * (x[0] - 0.6) : 0.0;
      return x;
    };
  scene.bodies.push_back(blockBody("upper", options, fem::Material::isotropic(1.0, 0.3)));
  return scene;
}

std::shared_ptr<const scene::Effect> jointOf(scene::Scene& scene, double gap = 0.0) {
  effects::SurfacePair pair;
  pair.first = {1, "bottom"};
  pair.second = {0, "top"};
  pair.coupling = effects::Coupling::Automatic;
  const auto contact = std::make_shared<effects::Contact>(pair, gap, "joint");
  scene.effects.push_back(contact);
  return contact;
}

using Fill = std::function<void(Teuchos::ParameterList& adhesions)>;

// What a deck with a contact "joint", an obstacle "floor" and a tie "seam" is told about its adhesion.
std::string refusalOf(const Fill& fill, scene::Physics physics = scene::Physics::PlaneStrain) {
  scene::EffectRegistry registry;
  effects::registerEffects(registry);
  ParameterSpec spec("deck", "A deck.");
  registry.addParameters(spec);
  Teuchos::ParameterList list;
  Teuchos::ParameterList& effects = list.sublist("Effects");
  for (const char* place : {"Contact/joint", "Tie/seam"}) {
    const std::string text = place;
    effects.sublist(text.substr(0, text.find('/')))
        .sublist(text.substr(text.find('/') + 1))
        .set("First", "upper/bottom")
        .set("Second", "lower/top");
  }
  if (physics != scene::Physics::Membrane)
    effects.sublist("Obstacle").sublist("floor").set("Part", "lower/bottom");
  fill(effects.sublist("Adhesion"));
  return inputErrorOf([&] {
    scene::Scene scene = blocks(physics);
    registry.addEffects(spec.validated(list, "test"), scene);
    for (const auto& effect : scene.effects)
      effect->check(scene);
  });
}

Teuchos::ParameterList& whole(Teuchos::ParameterList& list, const std::string& contact = "joint") {
  list.set("Contact", contact);
  list.set("Normal stiffness", 100.0).set("Tangential stiffness", 60.0);
  list.set("Normal strength", 1.0).set("Tangential strength", 0.8);
  return list.set("Fracture energy", 0.05).set("Fracture energy II", 0.08);
}

struct Rows {
  std::vector<ConstraintRow> contact, along; // by number, on this rank
};

Rows rowsOf(const std::vector<ConstraintRow>& rows) {
  Rows result;
  for (const ConstraintRow& row : rows) {
    if (row.kind == ConstraintRow::Kind::Inequality)
      result.contact.push_back(row);
    if (row.kind == ConstraintRow::Kind::Limited)
      result.along.push_back(row);
  }
  return result;
}

const contact::ContactPoint& pointOf(const scene::ContactSetup& setup, long long row) {
  return *std::find_if(setup.points.begin(), setup.points.end(),
                       [row](const contact::ContactPoint& point) { return point.number == row; });
}

const contact::SlipPoint& slipOf(const scene::ContactSetup& setup, long long row) {
  return *std::find_if(setup.slips.begin(), setup.slips.end(), [row](const contact::SlipPoint& slip) {
    return row >= slip.firstRow && row < slip.firstRow + static_cast<long long>(slip.tangents.size());
  });
}

} // namespace

TEST(Adhesion, decks_that_make_no_sense_are_refused) {
  const auto with = [](const std::string& name, double value) {
    return refusalOf([&](Teuchos::ParameterList& all) { whole(all.sublist("a")).set(name, value); });
  };
  const auto on = [](const std::string& contact) {
    return refusalOf([&](Teuchos::ParameterList& all) { whole(all.sublist("a"), contact); });
  };
  const auto without = [](const std::string& name) {
    return refusalOf([&](Teuchos::ParameterList& all) { whole(all.sublist("a")).remove(name); });
  };
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      EXPECT_TRUE(contains(text, word)) << word << " in: " << text;
  };
  EXPECT_EQ(on("joint"), "");
  EXPECT_EQ(on("Contact/joint"), "");
  EXPECT_EQ(on("floor"), "");
  expect(on("seam"), {"tie \"seam\"", "permanently glued", "a contact or an obstacle"});
  expect(on("jiont"), {"\"Effects/Adhesion/a/Contact\"", "jiont", "did you mean \"joint\""});
  for (const char* name :
       {"Normal stiffness", "Tangential stiffness", "Normal strength", "Tangential strength"}) {
    expect(without(name), {std::string("Effects/Adhesion/a/") + name, "missing"});
    expect(with(name, -2.0), {std::string("Effects/Adhesion/a/") + name, "not positive"});
    expect(with(name, 0.0), {std::string("Effects/Adhesion/a/") + name, "not positive"});
  }
  for (const char* name : {"Fracture energy", "Fracture energy II"}) {
    expect(without(name),
           {std::string("Effects/Adhesion/a/") + name, "missing", "the bilinear law needs an energy"});
    expect(refusalOf([&](Teuchos::ParameterList& all) {
             Teuchos::ParameterList& list = whole(all.sublist("a")).set("Law", "brittle");
             list.remove(std::string(name) == "Fracture energy" ? "Fracture energy II" : "Fracture energy");
           }),
           {std::string("Effects/Adhesion/a/") + name, "the brittle law does not use it"});
  }
  expect(with("Fracture energy", 0.004), {"Effects/Adhesion/a", "the law snap back", "5.0000e-03"});
  expect(with("Fracture energy II", 0.005), {"Effects/Adhesion/a", "the law snap back", "5.3333e-03"});
  expect(with("Mixed mode exponent", 0.0), {"Mixed mode exponent"});
  expect(refusalOf([](Teuchos::ParameterList& all) {
           whole(all.sublist("a"));
           whole(all.sublist("b"));
         }),
         {"adhesion \"a\"", "adhesion \"b\"", "contact \"joint\""});
  expect(refusalOf([](Teuchos::ParameterList& all) { whole(all.sublist("a")).set("Law", "brittel"); }),
         {"Law", "brittle", "bilinear"});
  expect(refusalOf([](Teuchos::ParameterList& all) { whole(all.sublist("a")); }, scene::Physics::Membrane),
         {"membrane"});
}

TEST(Adhesion, contacts_that_are_not_in_the_scene_are_refused) {
  scene::Scene scene = blocks(), other = blocks();
  scene.effects.push_back(std::make_shared<effects::Adhesion>(jointOf(other), brittle(), "a"));
  const std::string text = inputErrorOf([&] { runScene(scene, 1e-6); });
  EXPECT_TRUE(contains(text, "contact \"joint\", which is not an effect of the scene")) << text;
}

// Every point that touches has springs of stiffness times area, in the plane and in space, where meshes match
// and where they do not; a limited row in each direction along the surfaces, in space both in one disc.
TEST(Adhesion, binds_points_by_springs) {
  for (const auto physics : {scene::Physics::PlaneStrain, scene::Physics::Solid})
    for (const bool doesMatch : {true, false}) {
      scene::Scene scene = blocks(physics, doesMatch);
      scene.effects.push_back(std::make_shared<effects::Adhesion>(jointOf(scene), brittle(), "glue"));
      const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*testComm(), scene);
      const scene::ContactSetup setup = scene::setUpContact(*testComm(), scene, owned);
      const std::size_t tangents = physics == scene::Physics::Solid ? 2 : 1;
      ASSERT_EQ(setup.bonds.size(), setup.points.size());
      ASSERT_EQ(setup.slips.size(), setup.points.size());
      EXPECT_FALSE(setup.hasFriction);
      double area = 0.0;
      for (const contact::ContactPoint& point : setup.points)
        area += point.area;
      EXPECT_NEAR(globalSum(*testComm(), area), 1.0, 1e-12);
      const Rows rows = rowsOf(setup.rows);
      EXPECT_EQ(globalSum(*testComm(), static_cast<long long>(rows.along.size())),
                static_cast<long long>(tangents) * setup.pointCount);
      for (const ConstraintRow& row : rows.contact) {
        ASSERT_TRUE(row.softness);
        EXPECT_NEAR(*row.softness * pointOf(setup, row.number).area, 1.0 / 20.0, 1e-14);
      }
      for (const ConstraintRow& row : rows.along) {
        ASSERT_TRUE(row.softness);
        EXPECT_NEAR(*row.softness * setup.points[slipOf(setup, row.number).point].area, 1.0 / 40.0, 1e-14);
        EXPECT_EQ(row.limit, 0.0);
        EXPECT_EQ(row.normal, -1);
        EXPECT_EQ(row.disc >= 0, tangents == 2);
      }
      ASSERT_EQ(setup.notes.size(), 1u);
      EXPECT_TRUE(contains(setup.notes[0], "adhesion \"glue\" binds " + std::to_string(setup.pointCount) +
                                               " of the " + std::to_string(setup.pointCount) +
                                               " points of contact \"joint\""))
          << setup.notes[0];
    }
}

// Points apart, and all of a contact with a gap of its own, are contacts without adhesion.
TEST(Adhesion, points_apart_are_not_bound) {
  for (const double gap : {0.0, 0.01, -0.01}) {
    scene::Scene scene = blocks(scene::Physics::PlaneStrain, true, gap == 0.0 ? 0.05 : 0.0);
    const auto contact = jointOf(scene, gap);
    effects::SurfacePair pair;
    scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, brittle(), "glue"));
    const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*testComm(), scene);
    const scene::ContactSetup setup = scene::setUpContact(*testComm(), scene, owned);
    long long touching = 0;
    for (const contact::ContactPoint& point : setup.points)
      touching += point.position[0] < 0.45 && gap == 0.0 ? 1 : 0;
    EXPECT_EQ(static_cast<long long>(setup.bonds.size()), touching);
    EXPECT_EQ(static_cast<long long>(setup.slips.size()), touching);
    touching = globalSum(*testComm(), touching);
    EXPECT_EQ(touching > 0, gap == 0.0);
    EXPECT_LT(touching, setup.pointCount);
    EXPECT_EQ(setup.bondCount, touching);
    for (const ConstraintRow& row : rowsOf(setup.rows).contact)
      EXPECT_EQ(row.softness.has_value(), gap == 0.0 && pointOf(setup, row.number).position[0] < 0.45);
    bool isTold = false;
    for (const std::string& note : setup.notes)
      isTold = isTold || (contains(note, "binds " + std::to_string(touching) + " of the") &&
                          contains(note, "the other " + std::to_string(setup.pointCount - touching)));
    EXPECT_TRUE(isTold);
  }
}

// A rank has the states of its own points, damage and slips of each, and nothing of others.
TEST(Adhesion, states_are_where_their_points_are) {
  scene::Scene scene = blocks();
  const auto contact = jointOf(scene);
  scene.effects.push_back(std::make_shared<effects::Friction>(contact, effects::Coulomb(0.5), "rub"));
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, brittle(), "glue"));
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*testComm(), scene);
  const scene::ContactSetup setup = scene::setUpContact(*testComm(), scene, owned);
  const run::EffectStates states(*testComm(), scene, setup);
  constexpr std::size_t ofDamage = 11, ofSlips = 4;
  EXPECT_EQ(states.size(), setup.points.size() * (ofDamage + ofSlips));
  EXPECT_EQ(globalSum(*testComm(), static_cast<long long>(setup.points.size())), setup.pointCount);
}

// With friction the rows along the surfaces are its own, with springs while points hold: these are
// unstretched where the run began, whatever has slipped. Where a point breaks friction takes over, and slips
// are those from the last step on that was accepted. The point itself is a plain contact then.
TEST(Adhesion, friction_takes_over_what_is_broken) {
  scene::Scene scene = blocks();
  const auto contact = jointOf(scene);
  scene.effects.push_back(std::make_shared<effects::Friction>(contact, effects::Coulomb(0.5), "rub"));
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, brittle(), "glue"));
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*testComm(), scene);
  const scene::ContactSetup setup = scene::setUpContact(*testComm(), scene, owned);
  const std::size_t points = setup.points.size();
  ASSERT_EQ(setup.slips.size(), points);
  EXPECT_TRUE(setup.hasFriction);
  for (const ConstraintRow& row : rowsOf(setup.rows).along) {
    EXPECT_TRUE(row.softness);
    EXPECT_EQ(row.coefficient, 0.5);
  }
  run::EffectStates states(*testComm(), scene, setup);
  // Forces of a given stress at all points, twice that at the first; stretched by what springs say.
  const auto answer = [&](double traction, std::vector<run::ContactState>& contacts,
                          std::vector<run::RowSlip>& slips) {
    contacts.assign(points, {});
    slips.assign(points, {});
    for (std::size_t k = 0; k < points; ++k) {
      const double area = setup.points[setup.slips[k].point].area;
      slips[k].force = (setup.slips[k].firstRow == 0 ? 2.0 : 1.0) * traction * area;
      slips[k].slip = slips[k].force / (40.0 * area);
    }
  };
  std::vector<run::ContactState> contacts;
  std::vector<run::RowSlip> slips;
  states.begin();
  answer(0.4, contacts, slips); // at the first point 0.8 of the strength
  EXPECT_FALSE(states.update(contacts, slips, 1e-6));
  states.commit();
  states.begin();
  for (const ConstraintRow& row : rowsOf(states.rows()).along)
    EXPECT_EQ(row.bound, 0.0);
  answer(0.6, contacts, slips); // 1.2
  EXPECT_TRUE(states.update(contacts, slips, 1e-6));
  // The point of the first row, on whatever rank.
  const bool isHere = !setup.slips.empty() && setup.slips[0].firstRow == 0;
  const double area = globalSum(*testComm(), isHere ? setup.points[setup.slips[0].point].area : 0.0);
  const long long broken = globalMax(*testComm(), isHere ? setup.points[setup.slips[0].point].number : -1LL);
  EXPECT_NEAR(states.dissipated(), area * 0.5 / 40.0, 1e-15);
  for (const ConstraintRow& row : rowsOf(states.rows()).along) {
    const bool isBroken = row.number == 0;
    EXPECT_EQ(row.softness.has_value(), !isBroken);
    EXPECT_NEAR(row.bound, isBroken ? 0.8 / 40.0 : 0.0, 1e-15); // where the step before ended
  }
  for (const ConstraintRow& row : rowsOf(states.rows()).contact)
    EXPECT_EQ(row.softness.has_value(), row.number != broken);
  // It slips on by 0.1; the others hold.
  answer(0.6, contacts, slips);
  if (isHere)
    slips[0] = {0.1, 0.0};
  EXPECT_FALSE(states.update(contacts, slips, 1e-6));
  std::vector<run::ContactState> told = contacts;
  states.tell(slips, told);
  for (std::size_t k = 0; k < points; ++k) {
    EXPECT_TRUE(told[k].isBound);
    EXPECT_EQ(told[k].damage, setup.points[k].number == broken ? 1.0 : 0.0);
  }
  states.commit();
  states.begin();
  for (const ConstraintRow& row : rowsOf(states.rows()).along)
    EXPECT_NEAR(row.bound, row.number == 0 ? 0.8 / 40.0 + 0.1 : 0.0, 1e-15);
}

// A step that fails, or is halved, leaves no damage behind; points that adhesion has bound twice are bound
// once.
TEST(Adhesion, damage_of_a_step_that_failed_is_forgotten) {
  scene::Scene scene = blocks();
  const auto contact = jointOf(scene);
  scene.effects.push_back(std::make_shared<effects::Adhesion>(contact, brittle(), "glue"));
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(*testComm(), scene);
  const scene::ContactSetup setup = scene::setUpContact(*testComm(), scene, owned);
  run::EffectStates states(*testComm(), scene, setup);
  states.begin();
  std::vector<run::ContactState> contacts(setup.points.size());
  const std::vector<run::RowSlip> slips(setup.slipRows());
  for (std::size_t k = 0; k < contacts.size(); ++k)
    contacts[k].force = -1.1 * setup.points[k].area; // tension beyond the strength
  EXPECT_TRUE(states.update(contacts, slips, 1e-6));
  EXPECT_GT(states.haste(), 1.0);
  EXPECT_NEAR(states.dissipated(), 0.5 / 20.0, 1e-14);
  for (const ConstraintRow& row : states.rows())
    EXPECT_FALSE(row.softness);
  states.begin();
  EXPECT_EQ(states.haste(), 0.0);
  EXPECT_EQ(states.dissipated(), 0.0);
  for (const ConstraintRow& row : states.rows())
    EXPECT_TRUE(row.softness);
  // Compression breaks nothing, however large.
  for (run::ContactState& state : contacts)
    state.force *= -100.0;
  EXPECT_FALSE(states.update(contacts, slips, 1e-6));
  EXPECT_EQ(states.dissipated(), 0.0);
}

} // namespace test_adhesion
