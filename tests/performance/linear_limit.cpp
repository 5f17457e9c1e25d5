// SPDX-License-Identifier: BSD-3-Clause

/// Contact that is closed or open everywhere at the solution, against the linear problem with the same
/// solution: the dual problem solved as an application does, and with all that is set up for it. Writes JSON;
/// see README.md.

#include "Harmos_Exchange.hpp"
#include "Harmos_LinearLimit.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Tpetra_Core.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>

using namespace Harmos;

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Seconds of some solutions in a row, on the slowest rank.
double timed(const Teuchos::Comm<int>& comm, int calls, LimitProblem& problem, double tolerance,
             run::RunReport& report) {
  comm.barrier();
  const double start = now();
  for (int k = 0; k < calls; ++k)
    report = problem.solve(tolerance);
  return globalMax(comm, now() - start) / calls;
}

// Seconds of all that follows the mesh, on the slowest rank.
double timedWhole(const Teuchos::Comm<int>& comm, int calls, const TestModel& model, double tolerance) {
  comm.barrier();
  const double start = now();
  for (int k = 0; k < calls; ++k) {
    LimitProblem problem(model);
    problem.solve(tolerance);
    problem.audit();
  }
  return globalMax(comm, now() - start) / calls;
}

} // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = testComm();
  CLI::App app("Contact that turns out linear, against the linear problem");
  std::vector<int> subdomains = {4, 8}, sizes = {16, 32};
  int repetitions = 9;
  double tolerance = 1e-4;
  std::string output;
  app.add_option("--subdomains", subdomains, "S: subdomains a side")->delimiter(',');
  app.add_option("--sizes", sizes, "N: elements a subdomain side")->delimiter(',');
  app.add_option("--repetitions", repetitions, "pairs of runs, of which the median counts");
  app.add_option("--tolerance", tolerance, "of the solver");
  app.add_option("--output", output, "JSON file");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json runs = nlohmann::json::array();
  for (int s : subdomains)
    for (int n : sizes)
      for (bool closed : {true, false}) {
        constexpr int pattern = 2; // loads that differ between subdomains: the most steps
        const LinearLimit limit(s, n, closed, pattern);
        LimitProblem contact(limit.contact), linear(limit.linear);
        run::RunReport mine, theirs;
        const double estimate = timed(*comm, 1, linear, tolerance, theirs);
        const int calls = std::clamp(static_cast<int>(0.05 / estimate), 1, 100);
        const double whole = timedWhole(*comm, 1, limit.linear, tolerance);
        const int wholeCalls = std::clamp(static_cast<int>(0.05 / whole), 1, 100);
        std::vector<double> contactSeconds, linearSeconds, ratios, wholeRatios, wholeSeconds;
        for (int r = 0; r < repetitions; ++r) {
          linearSeconds.push_back(timed(*comm, calls, linear, tolerance, theirs));
          contactSeconds.push_back(timed(*comm, calls, contact, tolerance, mine));
          ratios.push_back(contactSeconds.back() / linearSeconds.back());
          const double wholeLinear = timedWhole(*comm, wholeCalls, limit.linear, tolerance);
          wholeSeconds.push_back(timedWhole(*comm, wholeCalls, limit.contact, tolerance));
          wholeRatios.push_back(wholeSeconds.back() / wholeLinear);
        }
        runs.push_back({{"subdomains_per_side", s},
                        {"elements_per_subdomain_side", n},
                        {"contact", closed ? "closed" : "open"},
                        {"converged", mine.converged && theirs.converged},
                        {"products", mine.result.counters.hessianApplications},
                        {"linear_products", theirs.result.counters.hessianApplications},
                        {"seconds", median(contactSeconds)},
                        {"linear_seconds", median(linearSeconds)},
                        {"ratio", median(ratios)},
                        {"whole_seconds", median(wholeSeconds)},
                        {"whole_ratio", median(wholeRatios)}});
        if (comm->getRank() == 0)
          std::cout << "S = " << s << ", N = " << n << (closed ? ", closed: " : ", open: ")
                    << mine.result.counters.hessianApplications << " products, linear "
                    << theirs.result.counters.hessianApplications << "; seconds " << median(contactSeconds)
                    << ", linear " << median(linearSeconds) << ", ratio " << median(ratios)
                    << "; with set-up " << median(wholeSeconds) << ", ratio " << median(wholeRatios)
                    << std::endl;
      }
  if (comm->getRank() == 0 && !output.empty()) {
    const nlohmann::json document = {{"benchmark", "linear_limit"},
                                     {"harmos", {{"version", version()}, {"git", gitHash()}}},
                                     {"ranks", comm->getSize()},
                                     {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
