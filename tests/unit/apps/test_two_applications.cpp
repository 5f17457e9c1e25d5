// SPDX-License-Identifier: BSD-3-Clause

/// Two applications in one process: what one does is not seen by the other, nor on the standard streams.

#include "Harmos_Deck.hpp"
#include "Harmos_FiberComposite.hpp"
#include "Harmos_Pipeline.hpp"
#include "Harmos_Signorini.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <filesystem>

namespace test_two_applications {

using namespace Harmos;

namespace {

using Comm = Teuchos::RCP<const Teuchos::Comm<int>>;
constexpr double tolerance = 1e-8;

struct Outcome {
  double energy;
  int iterations;
};

// An application on its default deck, made smaller.
Outcome solved(const app::Application& application, const std::vector<std::string>& assignments,
               const Comm& comm) {
  const ParameterSpec spec = app::deckSpec(application);
  Teuchos::ParameterList given;
  for (const std::string& assignment : assignments) {
    const std::size_t sign = assignment.find('=');
    spec.set(given, assignment.substr(0, sign), assignment.substr(sign + 1), "the test");
  }
  const Teuchos::ParameterList deck = spec.validated(given, "the test");
  run::RunOptions options = run::RunOptions::fromDeck(deck);
  options.tolerance = tolerance;
  options.writeFields = false;
  // Ranks that run alone write beside each other.
  options.outputDirectory = "two_applications_np" + std::to_string(testComm()->getSize()) + "/" +
                            application.name + std::to_string(testComm()->getRank() - comm->getRank());
  const Log silent;
  const scene::Scene scene = application.makeScene({*comm, deck, "./", silent});
  run::RunReport report;
  run::runScene(comm, scene, options, silent, std::chrono::steady_clock::now(), report);
  EXPECT_TRUE(report.converged) << application.name << ": " << report.reason;
  return {report.audit.energy, static_cast<int>(report.result.history.size())};
}

Outcome membranes(const Comm& comm) {
  return solved(app::signoriniApplication(),
                {"Model/Subdomains per side=2", "Model/Elements per subdomain side=8"}, comm);
}

Outcome composite(const Comm& comm) {
  return solved(app::fiberCompositeApplication(), {"Model/Columns=2", "Model/Rows=2"}, comm);
}

// Both to the tolerance: the energy is quadratic in the error.
void expectSame(const Outcome& one, const Outcome& other, bool exactly) {
  EXPECT_NEAR(one.energy, other.energy, (exactly ? 0.0 : 10.0 * tolerance) * std::abs(other.energy));
  if (exactly)
    EXPECT_EQ(one.iterations, other.iterations);
}

} // namespace

TEST(TwoApplications, in_turns_as_alone) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const Outcome first = membranes(testComm()), second = composite(testComm());
  expectSame(membranes(testComm()), first, true);
  expectSame(composite(testComm()), second, true);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// Each half of the ranks runs one of them while the other half runs the other; with one rank, in turns.
TEST(TwoApplications, at_once_on_disjoint_communicators) {
  const Comm world = testComm();
  const Outcome first = membranes(world), second = composite(world);
  const int color = world->getRank() % 2;
  const Comm half = world->split(color, world->getRank());
  testing::internal::CaptureStdout();
  const Outcome mine = color == 0 ? membranes(half) : composite(half);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  expectSame(mine, color == 0 ? first : second, false);
}

} // namespace test_two_applications
