// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Membranes.hpp"

#include "Harmos_StructuredBlock.hpp"

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

} // namespace Harmos::signorini
