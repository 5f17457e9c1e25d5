// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Membranes.hpp"

#include "Harmos_BodyForce.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_PrescribedDisplacement.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_Tie.hpp"

#include <memory>

namespace Harmos::signorini {

scene::Scene membranes(const Teuchos::ParameterList& model) {
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
    scene.bodies.push_back(std::move(body));
  }
  effects::SurfacePair seam;
  seam.first = {0, "right"};
  seam.second = {1, "left"};
  if (tied)
    scene.effects.push_back(std::make_shared<effects::Tie>(seam, "seam"));
  else
    scene.effects.push_back(std::make_shared<effects::Contact>(seam, 0.0, "seam"));
  const std::vector<fem::BoxLoad> onFirst = {{-3.0, {0.0, 0.75}, {1.0, 1.0}}},
                                  onSecond = {{-1.0, {1.0, 0.0}, {2.0, 0.25}}};
  scene.effects.push_back(std::make_shared<effects::BodyForce>(0, onFirst));
  scene.effects.push_back(std::make_shared<effects::BodyForce>(1, onSecond));
  scene.effects.push_back(effects::hold({0, "left"}, 0));
  return scene;
}

} // namespace Harmos::signorini
