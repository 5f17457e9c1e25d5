// SPDX-License-Identifier: BSD-3-Clause

/// The sparse factor of the coarse problem on grids of subdomains, each coupled to those two steps away:
/// entries, factorisation, and the pair of solves with L and its transpose that a projection takes. Writes
/// JSON; see README.md.

#include "Harmos_SparseCholesky.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

int main(int argc, char** argv) {
  CLI::App app("The sparse factor of the coarse problem");
  std::vector<int> sides = {32, 64, 128, 256};
  int repetitions = 20;
  std::string output;
  app.add_option("--sides", sides, "subdomains per side of the grid")->delimiter(',');
  app.add_option("--repetitions", repetitions);
  app.add_option("--output", output, "a JSON file");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json runs = nlohmann::json::array();
  for (const int side : sides) {
    const int n = side * side;
    std::vector<int> rows, columns;
    std::vector<double> values;
    for (int i = 0; i < n; ++i)
      for (int down = 0; down <= 2; ++down)
        for (int across = down - 2; across <= 2 - down; ++across) {
          const int row = i / side - down, column = i % side - across;
          const int j = row * side + column;
          if (row < 0 || column < 0 || column >= side || j > i)
            continue;
          rows.push_back(i);
          columns.push_back(j);
          values.push_back(i == j ? 12.5 : -1.0);
        }
    double start = now();
    const Harmos::feti::SparseCholesky factor(n, rows, columns, values);
    const double factorization = now() - start;
    std::vector<double> e(static_cast<std::size_t>(n), 1.0), seconds;
    for (int r = 0; r < repetitions; ++r) {
      start = now();
      e = factor.solveLt(factor.solveL(e));
      seconds.push_back(now() - start);
    }
    std::sort(seconds.begin(), seconds.end());
    const double solve = seconds[seconds.size() / 2];
    runs.push_back({{"order", n},
                    {"entries", factor.entries()},
                    {"entries_over_n_log2_n", factor.entries() / (n * std::log2(n))},
                    {"factorization_seconds", factorization},
                    {"solve_pair_seconds", solve},
                    {"entries_per_second", 2.0 * factor.entries() / solve}});
    std::cout << "order " << n << ": " << factor.entries() << " entries, factorisation " << factorization
              << " s, pair of solves " << solve << " s" << std::endl;
  }
  if (!output.empty()) {
    const nlohmann::json document = {{"benchmark", "coarse_factor"},
                                     {"harmos", {{"version", Harmos::version()}, {"git", Harmos::gitHash()}}},
                                     {"ranks", 1},
                                     {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
