// SPDX-License-Identifier: BSD-3-Clause

/// A run that fails after its output directory was opened leaves a summary with the cause, whatever the
/// fault.

#include "Harmos_Application.hpp"
#include "Harmos_Signorini.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <new>

namespace test_failed_run {

using namespace Harmos;

namespace {

// The summary that is left when the figures of a finished run throw.
template<class Fault>
nlohmann::json summaryAfter(const Fault& fault, const std::string& name) {
  app::Application application = app::signoriniApplication();
  application.evaluate = [&](const Teuchos::Comm<int>&, const Teuchos::ParameterList&, run::RunReport&) {
    throw fault;
  };
  app::CommandLine line;
  line.output = name + "_np" + std::to_string(testComm()->getSize());
  line.deck = line.output + ".xml";
  line.assignments = {"Model/Subdomains per side=2", "Model/Elements per subdomain side=4",
                      "Output/Fields=false"};
  if (testComm()->getRank() == 0) {
    std::filesystem::remove_all(line.output);
    std::ofstream(line.deck) << "<ParameterList/>\n";
  }
  testComm()->barrier();
  const Log silent;
  EXPECT_THROW(app::runDeck(application, {testComm(), line, silent, std::chrono::steady_clock::now()}),
               Fault);
  testComm()->barrier();
  std::ifstream file(line.output + "/summary.json");
  EXPECT_TRUE(file.good()) << "no summary";
  return nlohmann::json::parse(file, nullptr, false);
}

} // namespace

TEST(FailedRun, leaves_a_summary_with_the_cause) {
  const nlohmann::json summary = summaryAfter(InputError("the figures cannot be told"), "failed_figures");
  EXPECT_FALSE(summary["converged"].get<bool>());
  EXPECT_EQ(summary["reason"], "the figures cannot be told");
  EXPECT_GT(summary["seconds"]["total"].get<double>(), 0.0);
}

// Of a library, or no memory is left: each rank stands alone with it.
TEST(FailedRun, leaves_a_summary_after_a_fault_that_is_not_of_Harmos) {
  const nlohmann::json summary = summaryAfter(std::bad_alloc(), "failed_memory");
  EXPECT_FALSE(summary["converged"].get<bool>());
  EXPECT_NE(summary["reason"].get<std::string>().find("bad_alloc"), std::string::npos) << summary["reason"];
}

} // namespace test_failed_run
