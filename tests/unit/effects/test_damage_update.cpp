// SPDX-License-Identifier: BSD-3-Clause

/// Damage from solution to solution, where bodies are springs between which all is known: it settles with the
/// least damage that law and bodies agree on, in few solutions, however stiff the interface is.

#include "Harmos_Adhesion.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_DamageUpdate.hpp"
#include "Harmos_Softening.hpp"

#include <Teuchos_DefaultSerialComm.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

namespace test_damage_update {

using namespace Harmos;
using effects::CohesiveLaw;
using effects::DamageState;
using effects::DamageUpdate;

namespace {

// A strength of one, an opening of 1/k at it, and of `last` at the end.
CohesiveLaw lawOf(double stiffness, double last, CohesiveLaw::Kind kind = CohesiveLaw::Kind::Bilinear) {
  CohesiveLaw::Options options;
  options.kind = kind;
  options.normalStiffness = options.tangentialStiffness = stiffness;
  options.normalStrength = options.tangentialStrength = 1.0;
  options.fractureEnergy = options.fractureEnergyII = 0.5 * last;
  return CohesiveLaw(options);
}

// Springs of the interface: t = stiffness · (δ − unstretched).
struct Springs {
  std::vector<double> stiffness, unstretched;
};

Springs frozen(double stiffness, const std::vector<double>& damage) {
  Springs springs;
  for (double d : damage) {
    springs.stiffness.push_back((1.0 - d) * stiffness);
    springs.unstretched.push_back(0.0);
  }
  return springs;
}

// Points in a row, each on a spring to an end that moves, and coupled to its neighbours: openings δ of
// (K + C + k)δ = KU + ku, k the springs of the interface and u where they have no force.
std::vector<double> openings(const std::vector<double>& ends, double own, double coupling,
                             const Springs& springs) {
  const std::size_t n = ends.size();
  std::vector<double> diagonal(n), right(n), x(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double neighbours = (k > 0 ? 1.0 : 0.0) + (k + 1 < n ? 1.0 : 0.0);
    diagonal[k] = own + coupling * neighbours + springs.stiffness[k];
    right[k] = own * ends[k] + springs.stiffness[k] * springs.unstretched[k];
    if (k > 0) {
      diagonal[k] -= coupling * coupling / diagonal[k - 1];
      right[k] += coupling * right[k - 1] / diagonal[k - 1];
    }
  }
  for (std::size_t k = n; k-- > 0;)
    x[k] = (right[k] + (k + 1 < n ? coupling * x[k + 1] : 0.0)) / diagonal[k];
  return x;
}

DamageUpdate::Point at(const CohesiveLaw& law, double opening, double area = 1.0) {
  return {area, {std::sqrt(law.options().normalStiffness) * std::max(opening, 0.0), 0.0, 0.0}};
}

CohesiveLaw::Opening openingOf(const CohesiveLaw& law, double normal) {
  return {std::sqrt(law.options().normalStiffness) * std::max(normal, 0.0), 0.0};
}

// Points of area one, between bodies of such springs.
class Interface {
 public:
  Interface(const CohesiveLaw& law, std::size_t count, double ofBody, double ofNeighbours)
      : adhesion_(std::make_shared<effects::Contact>(effects::SurfacePair{}, 0.0, "joint"), law),
        own_(ofBody),
        coupling_(ofNeighbours),
        places_(count),
        states_(scene::PointStates::of<DamageState>(count)),
        softening_(alone_, keysOf(count), std::vector<double>(count, law.options().normalStiffness)) {
    for (std::size_t k = 0; k < count; ++k) {
      places_[k].area = 1.0;
      rows_.push_back({&places_[k], k, false});
    }
  }

  /// @param advance see run::Softening::begin(). @return nothing where it does not settle.
  std::vector<double> step(const std::vector<double>& ends, double tolerance,
                           std::optional<double> advance = std::nullopt) {
    adhesion_.beginStep(states_);
    softening_.begin(parts({}), advance);
    constexpr int many = 1000;
    for (solutions = 1; solutions < many; ++solutions) {
      const std::vector<double> open = openings(ends, own_, coupling_, springs());
      // Tractions are said to be known to ten times the tolerance.
      if (!softening_.update(parts(answerOf(open)), {}, 0.1 * tolerance, 1.0)) {
        softening_.commit();
        return open;
      }
    }
    return {};
  }

  double damage(std::size_t point) const { return adhesion_.damage(states_, point); }
  double dissipated() const { return adhesion_.broken(states_, rows_).dissipated; }
  double brokenShare() const {
    const scene::InterfaceLaw::Broken broken = adhesion_.broken(states_, rows_);
    return broken.share / broken.area;
  }
  void err(double error) { error_ = error; }
  double traction(double opening, std::size_t point) const {
    return (1.0 - damage(point)) * stiffness() * opening;
  }

  int solutions = 0;

 private:
  using Law = scene::InterfaceLaw;

  static std::vector<long long> keysOf(std::size_t count) {
    std::vector<long long> keys(count);
    std::iota(keys.begin(), keys.end(), 0LL);
    return keys;
  }

  double stiffness() const { return adhesion_.law().options().normalStiffness; }
  std::vector<run::Softening::Part> parts(std::vector<Law::RowAnswer> answer) {
    return {{&adhesion_, &rows_, std::move(answer), &states_}};
  }
  std::vector<Law::Spring> softened() const {
    std::vector<Law::Spring> result(rows_.size(), {1.0 / stiffness(), 0.0});
    adhesion_.soften(states_, rows_, result);
    return result;
  }
  Springs springs() const {
    Springs result;
    for (const Law::Spring& spring : softened()) {
      result.stiffness.push_back(spring.softness ? 1.0 / *spring.softness : 0.0);
      result.unstretched.push_back(-spring.unstretched);
    }
    return result;
  }
  // Forces are known to so much of the strength where springs are stiff, openings where they are soft.
  std::vector<Law::RowAnswer> answerOf(const std::vector<double>& open) {
    const std::vector<Law::Spring> its = softened();
    std::vector<Law::RowAnswer> answer(open.size());
    for (std::size_t k = 0; k < open.size(); ++k) {
      const double error = error_ * std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
      const double opening = open[k] + error / ((1.0 - damage(k)) * stiffness() + own_);
      static_cast<Law::Row&>(answer[k]) = rows_[k];
      answer[k].softness = its[k].softness;
      answer[k].unstretched = its[k].unstretched;
      answer[k].gap = opening;
      if (its[k].softness)
        answer[k].force = -(opening + its[k].unstretched) / *its[k].softness;
    }
    return answer;
  }

  const Teuchos::SerialComm<int> alone_;
  effects::Adhesion adhesion_;
  double own_, coupling_;
  std::vector<contact::ContactPoint> places_;
  std::vector<Law::Row> rows_;
  scene::PointStates states_;
  run::Softening softening_;
  double error_ = 0.0;
  std::mt19937 random_{3};
};

} // namespace

// One point between springs: the law is a straight line there, and the answer known. Springs of the interface
// a million times stiffer than the bodies take no more solutions. Two answers tell all of the bodies, and
// where they agree with the law: the elastic one, that of the first springs, the one looked for, and the last
// one through the origin; alone what is wrong would fall by 1.25/2.25 a time, to 1e-9 in 36.
TEST(DamageUpdate, one_point_settles_in_a_few_solutions) {
  constexpr double last = 0.1, tolerance = 1e-9;
  for (const double stiffness : {30.0, 1e3, 1e7}) {
    const CohesiveLaw law = lawOf(stiffness, last);
    const double first = 1.0 / stiffness, slope = 1.0 / (last - first), own = 2.0 * slope;
    Interface one(law, 1, own, 0.0);
    for (const double part : {0.2, 0.5, 0.9}) {
      const double opening = first + part * (last - first), pull = 1.0 - part;
      const std::vector<double> open = one.step({opening + pull / own}, tolerance);
      ASSERT_EQ(open.size(), 1u);
      EXPECT_LE(one.solutions, 6) << stiffness;
      // What is left of the traction beside the law moves the body by twice that over its stiffness.
      EXPECT_NEAR(open[0], opening, 4.0 * tolerance / own);
      EXPECT_NEAR(one.traction(open[0], 0), pull, 4.0 * tolerance);
    }
    // Back: to the origin, and no damage more or less.
    const double damage = one.damage(0);
    EXPECT_NEAR(one.step({0.0}, tolerance)[0], 0.0, 1e-14);
    EXPECT_EQ(one.damage(0), damage);
    EXPECT_EQ(one.solutions, 1);
    // All of it is spent where it breaks.
    one.step({2.0 * last}, tolerance);
    EXPECT_EQ(one.damage(0), 1.0);
    // Differences of openings that are a millionth of each other.
    EXPECT_NEAR(one.dissipated(), 0.5 * last, 1e-9 * last);
  }
}

// A row of points of which one end is pulled open further: a zone of softening moves along it, and each step
// ends where law and bodies agree at each point, from below: no damage is more than that which simple
// iteration, which never goes too far, comes to in thousands of solutions.
TEST(DamageUpdate, a_zone_of_softening_moves_along) {
  constexpr std::size_t points = 40;
  constexpr double stiffness = 1e4, last = 0.02, tolerance = 1e-8;
  const CohesiveLaw law = lawOf(stiffness, last);
  // Stable: stiffer, with the neighbours, than the law is steep, 50.
  Interface row(law, points, 80.0, 400.0);
  std::vector<double> simple(points, 0.0);
  int solutions = 0;
  for (int step = 1; step <= 30; ++step) {
    std::vector<double> ends;
    for (std::size_t k = 0; k < points; ++k)
      ends.push_back(0.06 * step / 30.0 * std::exp(-0.1 * static_cast<double>(k)));
    const std::vector<double> open = row.step(ends, tolerance);
    ASSERT_EQ(open.size(), points) << step;
    solutions += row.solutions;
    for (int k = 0; k < 20000; ++k) {
      const std::vector<double> now = openings(ends, 80.0, 400.0, frozen(stiffness, simple));
      double change = 0.0;
      for (std::size_t p = 0; p < points; ++p) {
        const double more = std::max(0.0, law.damage(openingOf(law, now[p])) - simple[p]);
        change = std::max(change, more * now[p] * stiffness);
        simple[p] += more;
      }
      if (change < 1e-3 * tolerance)
        break;
    }
    for (std::size_t k = 0; k < points; ++k) {
      const double expected = (1.0 - simple[k]) * stiffness * open[k];
      // Tractions of the law to the tolerance; by what that moves openings and the other way round less than
      // a hundred times as much.
      EXPECT_NEAR(row.traction(open[k], k), expected, 100.0 * tolerance) << step << " " << k;
    }
  }
  EXPECT_GT(row.damage(0), 0.999);
  EXPECT_GT(row.damage(points / 4), 0.0);
  EXPECT_EQ(row.damage(points - 1), 0.0);
  // Without what answers tell (1.25 · 50/(80 + 12.5))^47 = 1e-8; simple iteration takes thousands a step.
  EXPECT_LE(solutions, 30 * 10);
}

// Answers are known to a tolerance only: differences of those that differ by their errors say nothing, and
// what follows from them is not to be multiplied.
TEST(DamageUpdate, errors_of_answers_do_no_harm) {
  constexpr std::size_t points = 40;
  for (const double stiffness : {100.0, 1e4}) {
    const CohesiveLaw law = lawOf(stiffness, 0.03);
    constexpr double error = 1e-5, tolerance = 10.0 * error;
    Interface row(law, points, 80.0, 400.0);
    row.err(error);
    int solutions = 0;
    for (int step = 1; step <= 60; ++step) {
      std::vector<double> ends;
      for (std::size_t k = 0; k < points; ++k)
        ends.push_back(0.08 * step / 60.0 * std::exp(-0.1 * static_cast<double>(k)));
      ASSERT_EQ(row.step(ends, tolerance).size(), points) << step;
      EXPECT_LE(row.solutions, 40) << step;
      solutions += row.solutions;
    }
    EXPECT_EQ(row.damage(0), 1.0);
    EXPECT_LE(solutions, 60 * 6); // alone (1.25 · 33/(80 + 8))^12 = 1e-4
  }
}

// Where loads go on as they did the next answer is nearly known: bodies and law are linear as long as no
// point begins to soften.
TEST(DamageUpdate, steps_begin_where_loads_go_on_to) {
  constexpr double last = 0.1, tolerance = 1e-9;
  const CohesiveLaw law = lawOf(1e3, last);
  const double own = 2.0 / (last - 1e-3);
  Interface one(law, 1, own, 0.0);
  const auto ends = [&](double part) { return 1e-3 + part * (last - 1e-3) + (1.0 - part) / own; };
  one.step({ends(0.2)}, tolerance);
  one.step({ends(0.3)}, tolerance, 1.0);
  EXPECT_GT(one.solutions, 2);
  one.step({ends(0.45)}, 1e2 * tolerance, 1.5); // ends are known to the tolerance alone
  EXPECT_EQ(one.solutions, 2);                  // the second one with springs through the origin
  const double damage = one.damage(0);
  one.step({ends(0.3)}, tolerance, -1.0);
  EXPECT_EQ(one.solutions, 1); // back: springs as they are
  EXPECT_EQ(one.damage(0), damage);
}

// Where bodies are softer than the law is steep nothing holds a point back: it breaks at its strength, and
// not before.
TEST(DamageUpdate, points_snap_where_bodies_are_soft) {
  constexpr double last = 0.1, stiffness = 1e3;
  const CohesiveLaw law = lawOf(stiffness, last);
  const double own = 1.0; // 1/(last - first) is ten
  const double atStrength = 1.0 / stiffness + 1.0 / own;
  Interface one(law, 1, own, 0.0);
  one.step({0.999 * atStrength}, 1e-9);
  EXPECT_EQ(one.damage(0), 0.0);
  EXPECT_EQ(one.brokenShare(), 0.0);
  one.step({1.001 * atStrength}, 1e-9);
  EXPECT_EQ(one.damage(0), 1.0);
  EXPECT_NEAR(one.dissipated(), 0.5 * last, 1e-12);
  EXPECT_NEAR(one.brokenShare(), 1.0, 1e-12);
}

// The worst points break first; those that others relieve stay.
TEST(DamageUpdate, brittle_points_break_from_the_worst_on) {
  const CohesiveLaw law = lawOf(1e3, 0.0, CohesiveLaw::Kind::Brittle);
  scene::PointStates states = scene::PointStates::of<DamageState>(4);
  DamageUpdate update(law, states);
  update.beginStep();
  const std::vector<DamageUpdate::Point> places(4, at(law, 0.0, 2.0));
  const auto ask = [&](const std::vector<double>& strains) {
    std::vector<DamageUpdate::Point> points;
    for (double strain : strains)
      points.push_back(at(law, strain / 1e3, 2.0));
    const bool again = update.breakWorst(points, 1e-6, [](double value) { return value; });
    std::vector<double> damage;
    for (std::size_t k = 0; k < 4; ++k)
      damage.push_back(states.get<DamageState>(k).damage);
    return std::make_pair(again, damage);
  };
  const auto broken = [&] { return DamageUpdate::broken(law, states, places); };
  using Damage = std::vector<double>;
  EXPECT_EQ(ask({1.5, 1.4, 1.2, 0.5}), std::make_pair(true, Damage{1, 1, 0, 0}));
  EXPECT_EQ(ask({0, 0, 0.9, 0.5}), std::make_pair(false, Damage{1, 1, 0, 0}));
  EXPECT_EQ(ask({0, 0, 1.0 + 1e-7, 0.5}), std::make_pair(false, Damage{1, 1, 0, 0}));
  // σ²/2k each, whatever the openings were.
  EXPECT_NEAR(broken().dissipated, 2 * 2.0 * 0.5 / 1e3, 1e-15);
  EXPECT_NEAR(broken().share / broken().area, 0.5, 1e-12);
  update.beginStep();
  EXPECT_EQ(ask({0, 0, 1.1, 0.5}), std::make_pair(true, Damage{1, 1, 1, 0}));
  EXPECT_NEAR(broken().dissipated, 3 * 2.0 * 0.5 / 1e3, 1e-15);
  EXPECT_NEAR(broken().share / broken().area, 0.25, 1e-12);
  // What the worst point of another rank is beyond its strength counts.
  update.beginStep();
  EXPECT_TRUE(update.breakWorst({at(law, 0.0), at(law, 0.0), at(law, 0.0), at(law, 1.5 / 1e3)}, 1e-6,
                                [](double value) { return std::max(value, 2.0); }));
  EXPECT_EQ(states.get<DamageState>(3).damage, 0.0);
}

// A point that breaks was, on its way, where the law ends; there friction takes over. It stays broken as long
// as what the law says is not more than tractions are known to, and in the next step is broken for good.
TEST(DamageUpdate, broken_points_are_known_by_their_places) {
  constexpr double last = 0.1, known = 1e-3;
  const CohesiveLaw law = lawOf(100.0, last);
  const double root = std::sqrt(100.0);
  const auto slipped = [&](double slip) {
    return std::vector<DamageUpdate::Point>{{1.0, {0.0, 0.6 * root * slip, -0.8 * root * slip}}};
  };
  scene::PointStates states = scene::PointStates::of<DamageState>(1);
  DamageUpdate update(law, states);
  const auto state = [&] { return states.get<DamageState>(0); };
  update.beginStep();
  update.follow(slipped(0.9 * last), std::nullopt, known);
  EXPECT_FALSE(state().brokenAt());
  update.follow(slipped(1.5 * last), std::nullopt, known);
  const auto expectPlace = [&] {
    const auto at = state().brokenAt();
    ASSERT_TRUE(at);
    EXPECT_NEAR((*at)[1], 0.6 * root * last, 1e-12);
    EXPECT_NEAR((*at)[2], -0.8 * root * last, 1e-12);
  };
  expectPlace();
  // (1 − d)kδ = (last − δ)/(last − 0.01) of a strength of one.
  const double slope = 1.0 / (last - 0.01);
  update.follow(slipped(last - 0.9 * known / slope), std::nullopt, known);
  EXPECT_EQ(state().damage, 1.0);
  expectPlace();
  update.follow(slipped(last - 1.1 * known / slope), std::nullopt, known);
  EXPECT_LT(state().damage, 1.0);
  EXPECT_FALSE(state().brokenAt());
  update.follow(slipped(1.5 * last), std::nullopt, known);
  update.beginStep();
  EXPECT_FALSE(state().brokenAt());
}

} // namespace test_damage_update
