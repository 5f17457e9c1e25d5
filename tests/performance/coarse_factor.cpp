// SPDX-License-Identifier: BSD-3-Clause

/// The coarse problem on grids of subdomains, each coupled to those two steps away, by what a projection
/// takes of it.
///
/// Replicated: entries of the sparse factor, factorisation, and the pair of solves with L and its transpose.
/// Distributed: what one of many ranks does, a product of `--share` dense rows of A⁻, without the all-gather;
/// and on the ranks that there are the distributed factor itself, with rows of A⁻ where these fit into
/// `--rows-mib` a rank, else with solves. Writes JSON; see README.md.

#include "Harmos_DistributedFactor.hpp"
#include "Harmos_SparseCholesky.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_BLAS.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_GlobalMPISession.hpp>
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

struct Matrix {
  int order = 0;
  std::vector<int> rows, columns;
  std::vector<double> values;
};

Matrix gridMatrix(int side) {
  Matrix a;
  a.order = side * side;
  for (int i = 0; i < a.order; ++i)
    for (int down = 0; down <= 2; ++down)
      for (int across = down - 2; across <= 2 - down; ++across) {
        const int row = i / side - down, column = i % side - across;
        const int j = row * side + column;
        if (row < 0 || column < 0 || column >= side || j > i)
          continue;
        a.rows.push_back(i);
        a.columns.push_back(j);
        a.values.push_back(i == j ? 12.5 : -1.0);
      }
  return a;
}

template<class Work>
double medianSeconds(int repetitions, Work&& work) {
  std::vector<double> seconds;
  for (int r = 0; r < repetitions; ++r) {
    const double start = now();
    work();
    seconds.push_back(now() - start);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

// One rank's rows of A⁻, times a vector.
double shareSeconds(int n, int rows, int repetitions) {
  const std::vector<double> inverse(static_cast<std::size_t>(n) * static_cast<std::size_t>(rows), 1.0),
      t(static_cast<std::size_t>(n), 1.0);
  std::vector<double> s(static_cast<std::size_t>(rows));
  return medianSeconds(repetitions, [&] {
    Teuchos::BLAS<int, double>().GEMV(Teuchos::TRANS, n, rows, 1.0, inverse.data(), n, t.data(), 1, 0.0,
                                      s.data(), 1);
  });
}

// Rows of A in shares of the ranks, each with the entries of its own rows.
nlohmann::json distributed(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const Matrix& a, double mib,
                           int repetitions) {
  using Harmos::feti::DistributedFactor;
  using Harmos::feti::DistributedGraph;
  const int ranks = comm->getSize(), rank = comm->getRank();
  const auto firstOf = [&](int r) { return static_cast<int>(static_cast<long long>(a.order) * r / ranks); };
  const int first = firstOf(rank), own = firstOf(rank + 1) - first;
  std::vector<std::pair<int, int>> places;
  std::vector<double> values;
  for (std::size_t k = 0; k < a.values.size(); ++k)
    if (a.rows[k] >= first && a.rows[k] < first + own) {
      places.emplace_back(a.rows[k], a.columns[k]);
      values.push_back(a.values[k]);
    }
  const bool hasRows = 8.0 * a.order * own < mib * 1024.0 * 1024.0;
  comm->barrier();
  double start = now();
  const DistributedGraph graph(comm, own, places, 2);
  const DistributedFactor factor(
      graph, values, {hasRows ? DistributedFactor::Form::Rows : DistributedFactor::Form::Solves, 1e-12, {}});
  comm->barrier();
  const double setup = now() - start;
  const std::vector<double> e(static_cast<std::size_t>(own), 1.0);
  const double solve = medianSeconds(repetitions, [&] { factor.solve(e); });
  return {{"form", hasRows ? "rows" : "solves"}, {"group", graph.groupSize()}, {"entries", factor.entries()},
          {"bytes_of_rank", factor.bytes()},     {"setup_seconds", setup},     {"solve_seconds", solve}};
}

} // namespace

int main(int argc, char** argv) {
  const Teuchos::GlobalMPISession session(&argc, &argv, nullptr);
  const Teuchos::RCP<const Teuchos::Comm<int>> comm = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_WORLD));
  const bool isFirst = comm->getRank() == 0;
  CLI::App app("The coarse problem, replicated and distributed");
  std::vector<int> sides = {32, 64, 128, 256};
  int repetitions = 20, share = 16;
  double mib = 512.0;
  std::string output;
  app.add_option("--sides", sides, "subdomains per side of the grid")->delimiter(',');
  app.add_option("--repetitions", repetitions);
  app.add_option("--share", share, "rows of a rank of many");
  app.add_option("--rows-mib", mib, "the most that rows of the inverse may take on a rank");
  app.add_option("--output", output, "a JSON file");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json runs = nlohmann::json::array();
  for (const int side : sides) {
    const Matrix a = gridMatrix(side);
    const int n = a.order;
    const double start = now();
    const Harmos::feti::SparseCholesky factor(n, a.rows, a.columns, a.values);
    const double factorization = now() - start;
    std::vector<double> e(static_cast<std::size_t>(n), 1.0);
    const double solve = medianSeconds(repetitions, [&] { e = factor.solveLt(factor.solveL(e)); });
    const double ofShare = shareSeconds(n, share, repetitions);
    const nlohmann::json shared = distributed(comm, a, mib, repetitions);
    runs.push_back({{"order", n},
                    {"entries", factor.entries()},
                    {"entries_over_n_log2_n", factor.entries() / (n * std::log2(n))},
                    {"factorization_seconds", factorization},
                    {"solve_pair_seconds", solve},
                    {"entries_per_second", 2.0 * factor.entries() / solve},
                    {"share_rows", share},
                    {"share_seconds", ofShare},
                    {"share_bytes_per_second", 8.0 * n * share / ofShare},
                    {"distributed", shared}});
    if (isFirst)
      std::cout << "order " << n << ": " << factor.entries() << " entries, factorisation " << factorization
                << " s, pair of solves " << solve << " s; " << share << " rows of the inverse " << ofShare
                << " s; distributed on " << comm->getSize() << " ranks, " << shared["form"] << ": set-up "
                << shared["setup_seconds"] << " s, a solve " << shared["solve_seconds"] << " s" << std::endl;
  }
  if (!output.empty() && isFirst) {
    const nlohmann::json document = {{"benchmark", "coarse_factor"},
                                     {"harmos", {{"version", Harmos::version()}, {"git", Harmos::gitHash()}}},
                                     {"ranks", comm->getSize()},
                                     {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
