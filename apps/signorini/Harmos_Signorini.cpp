// SPDX-License-Identifier: BSD-3-Clause

/// The semicoercive model problem of Dostál, Horák, Vlach (section 2): two membranes over (0,1)×(0,1) and
/// (1,2)×(0,1),
///
///     min Σ ½∫|∇uⁱ|² − ∫fuⁱ   subject to   u¹ = 0 at x = 0,   u² − u¹ ≥ 0 at x = 1,
///
/// f = −3 on (0,1)×[0.75,1), −1 on (1,2)×[0,0.25), 0 elsewhere. The second membrane is held by the contact
/// alone.

#include "Harmos_Application.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <memory>

namespace {

using namespace Harmos;

void addParameters(ParameterSpec& deck) {
  ParameterSpec model("Model", "Geometry and discretisation of the two membranes.");
  model.integer("Subdomains per side", 4, 1, 1024, "1/H: each membrane is cut into its square.");
  model.integer("Elements per subdomain side", 8, 1, 4096, "H/h: Q1 elements along the side of a subdomain.");
  model.choice("Interface", "contact",
               {{"contact", "the second membrane lies on or above the first one: u² − u¹ ≥ 0"},
                {"tie", "the membranes are tied: u² = u¹"}},
               "What holds at x = 1.");
  deck.list(std::move(model));
}

scene::Scene makeScene(const app::DeckContext& context) {
  const Teuchos::ParameterList& model = context.deck.sublist("Model");
  const int s = model.get<int>("Subdomains per side");
  const int n = model.get<int>("Elements per subdomain side");
  const bool tied = model.get<std::string>("Interface") == "tie";

  scene::Scene scene;
  scene.name = "two membranes";
  long long firstNode = 0;
  for (int b = 0; b < 2; ++b) {
    const auto rectangle = std::make_shared<const fem::StructuredBlock>(
        fem::makeRectangle(fem::Point{static_cast<double>(b), 0.0, 0.0}, std::array<double, 2>{1.0, 1.0},
                           std::array<int, 2>{s, s}, std::array<int, 2>{n, n}, firstNode));
    firstNode += rectangle->numberOfNodes();
    scene::Body body;
    body.name = b == 0 ? "first membrane" : "second membrane";
    body.subdomains = rectangle->numberOfSubdomains();
    body.subdomain = [rectangle](int k) { return rectangle->subdomain(k); };
    if (b == 0) {
      body.bodyForce = {{-3.0, {0.0, 0.75}, {1.0, 1.0}}};
      body.prescribed = {{"left", 0.0}};
    } else {
      body.bodyForce = {{-1.0, {1.0, 0.0}, {2.0, 0.25}}};
    }
    scene.bodies.push_back(std::move(body));
  }
  scene.interfaces = {
      {tied ? scene::Interface::Kind::Tie : scene::Interface::Kind::Contact, 0, "right", 1, "left"}};
  return scene;
}

} // namespace

int main(int argc, char** argv) {
  return app::main(argc, argv,
                   {"signorini", "the Signorini model problem: two membranes in contact", addParameters,
                    makeScene, nullptr});
}
