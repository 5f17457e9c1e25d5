// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Assembly.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_FittedRate.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_Pipeline.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <functional>
#include <string>
#include <vector>

namespace Harmos {

/// A body of one structured block; its nodes are numbered from options.firstNode on, which is moved past
/// them.
scene::Body blockBody(const std::string& name, fem::StructuredBlock::Options& options,
                      const fem::Material& material);

/// A boundary part of a body, by its number in the scene.
struct Part {
  int body;
  std::string set;
};

// What tests put into scenes; the first part of a pair carries the multipliers.
void addContact(scene::Scene& scene, const Part& first, const Part& second, double gap = 0.0,
                double reach = 0.0);
void addTie(scene::Scene& scene, const Part& first, const Part& second);
void addObstacle(scene::Scene& scene, const Part& part, const contact::Obstacle& obstacle);
void prescribe(scene::Scene& scene, const Part& part, int component, double value = 0.0);
void prescribe(scene::Scene& scene, const Part& part, int component,
               const std::function<double(const fem::Point&)>& field);
void addTraction(scene::Scene& scene, const Part& part, const fem::Point& density);
void addTraction(scene::Scene& scene, const Part& part, const fem::Traction& density);
/// Per volume, of elastic bodies.
void addForce(scene::Scene& scene, int body, const fem::Point& density);
void addForce(scene::Scene& scene, int body, const fem::VectorField& density);
/// Of membranes.
void addForce(scene::Scene& scene, int body, const std::vector<fem::BoxLoad>& loads);
void addTemperature(scene::Scene& scene, int body, double rise);
/// Takes all effects of a kind out again.
void removeEffects(scene::Scene& scene, const std::string& kind);

/// A finished run of a scene, without files beyond the summary's directory.
struct TestRun {
  run::Solution solution;
  run::RunReport report;
};

/// The options of the default deck, but for these; without files beyond the summary's directory.
run::RunOptions testOptions(double tolerance, const std::vector<std::string>& assignments = {});

/// Runs a scene with the default deck, to a tolerance; assignments as with --set. With HARMOS_TEST_LOG in the
/// environment rank 0 tells what happens.
/// @param comm null: all ranks. Each rank may also run a scene by itself.
TestRun runScene(const scene::Scene& scene, double tolerance,
                 const std::vector<std::string>& assignments = {},
                 const Teuchos::RCP<const Teuchos::Comm<int>>& comm = Teuchos::null);

/// The message of the error that a run ends in; "" if it ends well.
std::string failureOf(const scene::Scene& scene);

} // namespace Harmos
