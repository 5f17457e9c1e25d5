// SPDX-License-Identifier: BSD-3-Clause

/// An effect that a scene does not name costs nothing: its run is bit for bit the one of a program that has
/// never heard of the effect, and no object, timer, row or byte is there for it.

#include "Harmos_Effects.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_TimeMonitor.hpp>
#include <gtest/gtest.h>

#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <tuple>

namespace test_absence {

using namespace Harmos;

namespace {

scene::EffectRegistry everyKind() {
  scene::EffectRegistry registry;
  effects::registerEffects(registry);
  return registry;
}

scene::EffectRegistry allBut(const std::string& name) {
  const scene::EffectRegistry all = everyKind();
  scene::EffectRegistry registry;
  for (const scene::EffectKind& kind : all.kinds())
    if (kind.name != name)
      registry.add(kind);
  return registry;
}

void put(Teuchos::ParameterList& effects, const std::string& kind, const std::string& name,
         const std::map<std::string, std::string>& texts,
         const std::map<std::string, std::array<double, 3>>& points = {},
         const std::map<std::string, double>& numbers = {}) {
  Teuchos::ParameterList& list = effects.sublist(kind).sublist(name);
  for (const auto& [key, value] : texts)
    list.set(key, value);
  for (const auto& [key, value] : points)
    list.set(key, Teuchos::Array<double>(value.begin(), value.end()));
  for (const auto& [key, value] : numbers)
    list.set(key, value);
}

// Effects of seven kinds at a step of three blocks: A below B, and D tied to B on its right, on a floor of
// its own. The scene has a solution without any one of them, too.
Teuchos::ParameterList deckOfEffects() {
  Teuchos::ParameterList deck;
  Teuchos::ParameterList& effects = deck.sublist("Effects");
  put(effects, "Tie", "seam", {{"First", "D/left"}, {"Second", "B/right"}});
  put(effects, "Contact", "joint", {{"First", "B/bottom"}, {"Second", "A/top"}});
  put(effects, "Obstacle", "floor", {{"Part", "D/bottom"}}, {{"Point", {0, 1, 0}}});
  put(effects, "Obstacle", "ground", {{"Part", "A/bottom"}});
  put(effects, "Obstacle", "right wall", {{"Part", "D/right"}},
      {{"Point", {2, 0, 0}}, {"Direction", {-1, 0, 0}}});
  for (const char* body : {"A", "B"})
    put(effects, "Obstacle", std::string("left wall of ") + body, {{"Part", std::string(body) + "/left"}},
        {{"Direction", {1, 0, 0}}});
  put(effects, "Body force", "on A", {{"Body", "A"}}, {{"Density", {-0.002, -0.01, 0}}});
  put(effects, "Body force", "on B", {{"Body", "B"}}, {{"Density", {-0.002, -0.01, 0}}});
  put(effects, "Body force", "on D", {{"Body", "D"}}, {{"Density", {0.001, -0.01, 0}}});
  put(effects, "Traction", "on B", {{"Part", "B/top"}}, {}, {{"Pressure", 0.02}});
  put(effects, "Traction", "on D", {{"Part", "D/top"}}, {}, {{"Pressure", 0.01}});
  put(effects, "Prescribed displacement", "base", {{"Part", "A/bottom"}});
  put(effects, "Prescribed displacement", "side", {{"Part", "B/left"}});
  effects.sublist("Prescribed displacement")
      .sublist("side")
      .set("Components", Teuchos::Array<std::string>(1, "x"));
  put(effects, "Thermal strain", "warm", {{"Body", "D"}}, {}, {{"Temperature", 1.0}});
  return deck;
}

Teuchos::ParameterList without(Teuchos::ParameterList deck, const std::string& kind) {
  deck.sublist("Effects").remove(kind, false);
  return deck;
}

scene::Scene sceneOf(const scene::EffectRegistry& registry, const Teuchos::ParameterList& effects) {
  ParameterSpec spec("deck", "A deck.");
  registry.addParameters(spec);
  const Teuchos::ParameterList deck = spec.validated(effects, "test");
  scene::Scene scene;
  scene.physics = scene::Physics::PlaneStrain;
  fem::Material material = fem::Material::isotropic(1.0, 0.3);
  material.expansion = {0.01, 0.01, 0.01};
  fem::StructuredBlock::Options options;
  options.subdomains = {2, 2, 1};
  options.elements = {3, 3, 1};
  scene.bodies.push_back(blockBody("A", options, material));
  options.origin = {0.0, 1.0, 0.0};
  scene.bodies.push_back(blockBody("B", options, material));
  options.origin = {1.0, 1.0, 0.0};
  scene.bodies.push_back(blockBody("D", options, material));
  registry.addEffects(deck, scene);
  return scene;
}

std::string counterOf(const std::string& kind) {
  return "Harmos: effect " + kind;
}

bool hasTimer(const std::string& kind) {
  return !Teuchos::TimeMonitor::lookupCounter(counterOf(kind)).is_null();
}

const scene::EffectCost* costOf(const run::RunReport& report, const std::string& kind) {
  const auto found = std::find_if(report.effectCosts.begin(), report.effectCosts.end(),
                                  [&](const scene::EffectCost& cost) { return cost.kind == kind; });
  return found == report.effectCosts.end() ? nullptr : &*found;
}

// The forms whose systems differ most: with the trivial equations and without, direct and dense.
const std::vector<std::vector<std::string>> forms = {
    {"Decomposition/Dirichlet=primal", "Dual operator/Form=condensed"},
    {"Decomposition/Dirichlet=dual", "Dual operator/Form=implicit"}};

template<class Values>
void expectSameBits(const Values& a, const Values& b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << what;
}

std::vector<double> valuesOf(const MultiVector& x) {
  const auto view = x.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<double> values;
  for (std::size_t k = 0; k < view.extent(0); ++k)
    values.push_back(view(k, 0));
  return values;
}

// Displacements, multipliers and every number of every iteration, but seconds.
void expectSameRun(const TestRun& a, const TestRun& b, const std::string& what) {
  ASSERT_EQ(a.solution.displacement.size(), b.solution.displacement.size());
  for (std::size_t i = 0; i < a.solution.displacement.size(); ++i)
    expectSameBits(a.solution.displacement[i], b.solution.displacement[i], what + ": displacements");
  expectSameBits(valuesOf(*a.solution.multipliers), valuesOf(*b.solution.multipliers),
                 what + ": multipliers");
  const auto &one = a.report.result.history, &other = b.report.result.history;
  ASSERT_EQ(one.size(), other.size()) << what;
  for (std::size_t k = 0; k < one.size(); ++k) {
    const auto numbers = [](const qp::IterationRecord& record) {
      return std::make_tuple(record.outer, record.inner, record.step, record.projectedGradient,
                             record.equalityResidual, record.penalty, record.active,
                             record.hessianApplications);
    };
    EXPECT_EQ(numbers(one[k]), numbers(other[k])) << what << ", iteration " << k;
  }
  EXPECT_EQ(a.report.audit.energy, b.report.audit.energy) << what;
  EXPECT_EQ(a.report.dualDimension, b.report.dualDimension) << what;
  EXPECT_EQ(a.report.inequalities, b.report.inequalities) << what;
  EXPECT_EQ(a.report.kernelDimension, b.report.kernelDimension) << what;
}

} // namespace

// Every registered kind, those to come included.
TEST(Absence, scene_without_an_effect_is_the_run_without_its_class) {
  const scene::EffectRegistry all = everyKind();
  for (const scene::EffectKind& kind : all.kinds())
    for (const auto& form : forms) {
      const std::string what = "without " + kind.name + ", " + form[0];
      const Teuchos::ParameterList deck = without(deckOfEffects(), kind.name);
      const long long made = scene::Effect::count(kind.name).made;
      Teuchos::TimeMonitor::clearCounter(counterOf(kind.name));
      const TestRun known = runScene(sceneOf(all, deck), 1e-6, form);
      const TestRun unknown = runScene(sceneOf(allBut(kind.name), deck), 1e-6, form);
      EXPECT_TRUE(known.report.converged) << what << ": " << known.report.reason;
      expectSameRun(known, unknown, what);
      EXPECT_EQ(scene::Effect::count(kind.name).made, made) << what;
      EXPECT_EQ(scene::Effect::count(kind.name).living, 0) << what;
      EXPECT_FALSE(hasTimer(kind.name)) << what;
      EXPECT_EQ(costOf(known.report, kind.name), nullptr) << what;
    }
}

// The counters count: with the effect there are objects, a timer, rows where it gives some, and bytes; and
// it changes the answer.
TEST(Absence, scene_with_an_effect_has_what_it_costs) {
  const scene::EffectRegistry all = everyKind();
  const Teuchos::ParameterList deck = deckOfEffects();
  for (const auto& form : forms) {
    const bool dual = form[0] == "Decomposition/Dirichlet=dual";
    const scene::Scene scene = sceneOf(all, deck);
    const Teuchos::ParameterList& named = deck.sublist("Effects");
    for (auto item = named.begin(); item != named.end(); ++item)
      Teuchos::TimeMonitor::clearCounter(counterOf(named.name(item)));
    const TestRun run = runScene(scene, 1e-6, form);
    EXPECT_TRUE(run.report.converged) << run.report.reason;
    int kinds = 0;
    for (auto item = named.begin(); item != named.end(); ++item, ++kinds) {
      const std::string& kind = named.name(item);
      EXPECT_EQ(scene::Effect::count(kind).living, named.sublist(kind).numParams()) << kind;
      EXPECT_TRUE(hasTimer(kind)) << kind;
      const scene::EffectCost* cost = costOf(run.report, kind);
      ASSERT_NE(cost, nullptr) << kind;
      EXPECT_EQ(cost->effects, named.sublist(kind).numParams()) << kind;
      const bool givesRows = kind == "Tie" || kind == "Contact" || kind == "Obstacle" ||
                             (kind == "Prescribed displacement" && dual);
      EXPECT_EQ(cost->rows > 0, givesRows) << kind << " " << cost->rows;
      // A load vector is one, whatever the number of effects in it, and counts with the first.
      EXPECT_EQ(cost->bytes > 0.0, kind != "Traction" && kind != "Thermal strain") << kind;
      EXPECT_GE(cost->seconds, 0.0) << kind;
      const TestRun less = runScene(sceneOf(all, without(deck, kind)), 1e-6, form);
      EXPECT_NE(less.report.audit.energy, run.report.audit.energy) << kind;
    }
    EXPECT_EQ(kinds, 7);
    EXPECT_EQ(run.report.effectCosts.size(), 7u);
    // The rows are those of the effects, and of the gluing of subdomains, which is none.
    const TestRun bare = runScene(sceneOf(all, without(deck, "Tie")), 1e-6, form);
    EXPECT_EQ(run.report.dualDimension - bare.report.dualDimension, costOf(run.report, "Tie")->rows);
  }
}

} // namespace test_absence
