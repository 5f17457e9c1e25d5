// SPDX-License-Identifier: BSD-3-Clause

/// The vector part of a conjugate gradient step of MPRGP, fused (BoundTraits) against the same step composed
/// of Belos' MultiVecTraits and one function for each definition; writes JSON, see README.md.

#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_TrilinosVersion.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_MultiVector.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <vector>

using namespace Harmos;

namespace {

using MVT = Belos::MultiVecTraits<Scalar, MultiVector>;
using Bounds = qp::BoundOps<Scalar, MultiVector>;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double dot(const MultiVector& x, const MultiVector& y) {
  std::vector<double> result(1);
  MVT::MvDot(x, y, result);
  return result[0];
}

// x ≥ 0 with a third of the entries at the bound; the same numbers for both variants.
struct State {
  explicit State(const Teuchos::RCP<const Map>& map)
      : x(map, 1), g(map, 1), p(map, 1), image(map, 1), lower(map, 1) {
    Bounds::setRandom(x);
    Bounds::setRandom(g);
    Bounds::setRandom(image);
    const auto xs = x.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t i = 0; i < xs.extent(0); ++i)
      xs(i, 0) = i % 3 == 0 ? 0.0 : 1.0 + xs(i, 0) * xs(i, 0);
    sums = Bounds::split(x, g, {&lower}, 1.0, &p, active);
  }
  MultiVector x, g, p, image, lower;
  qp::ActiveFace active;
  qp::SplitSums sums;
};

// What a step leaves for the next decision; compared between the variants.
struct Outcome {
  double freeNorm2, choppedNorm2, reducedNorm2, longestStep;
};

// The image is no product with a matrix here: a β that would let p grow is damped, in both variants alike.
double damped(double beta) {
  return 0.5 * beta / (1.0 + std::abs(beta));
}

// The step length is small and fixed, so that repeated steps stay inside of the bounds.
constexpr double step = 1e-9, stepLength = 1.0;

Outcome fused(State& s) {
  const qp::CurvatureSums along = Bounds::curvature(s.g, s.p, s.image, s.active);
  const double beta = damped((along.freeDotImage - step * along.freeImageNorm2) / along.directionDotImage);
  const qp::SplitSums sums =
      Bounds::advance(s.x, s.g, s.p, s.image, step, beta, false, {&s.lower}, stepLength, s.p, s.active);
  return {sums.freeNorm2, sums.choppedNorm2, sums.reducedNorm2, sums.longestStep};
}

// One function for each line of the method.
struct Naive {
  explicit Naive(const Teuchos::RCP<const Map>& map) : phi(map, 1), beta(map, 1), reduced(map, 1) {}
  MultiVector phi, beta, reduced;

  Outcome operator()(State& s) {
    const double curvature = dot(s.p, s.image);
    MVT::MvAddMv(1.0, s.x, -step, s.p, s.x);
    MVT::MvAddMv(1.0, s.g, -step, s.image, s.g);
    freeGradient(s);
    choppedGradient(s);
    reducedGradient(s);
    const double freeNorm2 = dot(phi, phi), choppedNorm2 = dot(beta, beta), reducedNorm2 = dot(reduced, phi);
    const double factor = damped(dot(phi, s.image) / curvature);
    MVT::MvAddMv(1.0, phi, -factor, s.p, s.p);
    return {freeNorm2, choppedNorm2, reducedNorm2, longestStep(s)};
  }

  void freeGradient(State& s) {
    const auto x = s.x.getLocalViewHost(Tpetra::Access::ReadOnly),
               g = s.g.getLocalViewHost(Tpetra::Access::ReadOnly),
               l = s.lower.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto out = phi.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < x.extent(0); ++i)
      out(i, 0) = x(i, 0) > l(i, 0) ? g(i, 0) : 0.0;
  }
  void choppedGradient(State& s) {
    const auto x = s.x.getLocalViewHost(Tpetra::Access::ReadOnly),
               g = s.g.getLocalViewHost(Tpetra::Access::ReadOnly),
               l = s.lower.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto out = beta.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < x.extent(0); ++i)
      out(i, 0) = x(i, 0) <= l(i, 0) ? std::min(g(i, 0), 0.0) : 0.0;
  }
  void reducedGradient(State& s) {
    const auto x = s.x.getLocalViewHost(Tpetra::Access::ReadOnly),
               f = phi.getLocalViewHost(Tpetra::Access::ReadOnly),
               l = s.lower.getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto out = reduced.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < x.extent(0); ++i)
      out(i, 0) = f(i, 0) > 0.0 ? std::min((x(i, 0) - l(i, 0)) / stepLength, f(i, 0)) : f(i, 0);
  }
  double longestStep(State& s) {
    const auto x = s.x.getLocalViewHost(Tpetra::Access::ReadOnly),
               p = s.p.getLocalViewHost(Tpetra::Access::ReadOnly),
               l = s.lower.getLocalViewHost(Tpetra::Access::ReadOnly);
    double result = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < x.extent(0); ++i)
      if (p(i, 0) > 0.0)
        result = std::min(result, (x(i, 0) - l(i, 0)) / p(i, 0));
    return globalMin(*s.x.getMap()->getComm(), result);
  }
};

// Bytes a second of a = b + s c on this machine, all ranks at once, with arrays as long as the vectors.
double triad(const Teuchos::Comm<int>& comm, std::size_t n, int repetitions) {
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  double best = 1e300;
  for (int r = 0; r < repetitions; ++r) {
    comm.barrier();
    const double start = now();
    for (std::size_t i = 0; i < n; ++i)
      a[i] = b[i] + (0.5 + r) * c[i];
    best = std::min(best, globalMax(comm, now() - start));
  }
  // The store reads its line first: four streams.
  return a[n / 2] == -1.0 ? 0.0 : 32.0 * static_cast<double>(n) * comm.getSize() / best;
}

template<class Step>
double median(const Teuchos::Comm<int>& comm, int repetitions, int steps, Step&& one) {
  std::vector<double> seconds;
  for (int r = 0; r < repetitions; ++r) {
    comm.barrier();
    const double start = now();
    for (int k = 0; k < steps; ++k)
      one();
    seconds.push_back(globalMax(comm, now() - start) / steps);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

} // namespace

int main(int argc, char** argv) {
  Tpetra::ScopeGuard guard(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  CLI::App app("Vector kernels of MPRGP");
  std::vector<long long> sizes = {10000, 100000, 1000000, 10000000};
  int repetitions = 7;
  std::string output;
  app.add_option("--sizes", sizes, "entries of a vector, over all ranks")->delimiter(',');
  app.add_option("--repetitions", repetitions);
  app.add_option("--output", output, "a JSON file");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json runs = nlohmann::json::array();
  for (const long long size : sizes) {
    const auto map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(size), 0, comm));
    const int steps = static_cast<int>(std::max(3LL, 20000000LL / size));
    State forFused(map), forNaive(map);
    Naive naive(map);
    Outcome a{}, b{};
    // Turn and turn about, so that a disturbance meets both.
    std::vector<double> ratios, fusedSeconds, naiveSeconds;
    for (int r = 0; r < repetitions; ++r) {
      fusedSeconds.push_back(median(*comm, 1, steps, [&] { a = fused(forFused); }));
      naiveSeconds.push_back(median(*comm, 1, steps, [&] { b = naive(forNaive); }));
      ratios.push_back(naiveSeconds.back() / fusedSeconds.back());
    }
    for (auto* values : {&ratios, &fusedSeconds, &naiveSeconds})
      std::sort(values->begin(), values->end());
    const auto middle = static_cast<std::size_t>(repetitions / 2);
    const double stream = triad(*comm, localSize(*map), repetitions);
    // curvature: g, p, Hp; advance: x, g, p, Hp, l read, x, g, p written; and one byte of the set in each.
    const double bytes = (3 + 5 + 3) * 8.0 * static_cast<double>(size) + 3.0 * static_cast<double>(size);
    const bool agree = std::abs(a.freeNorm2 - b.freeNorm2) <= 1e-9 * b.freeNorm2 &&
                       std::abs(a.choppedNorm2 - b.choppedNorm2) <= 1e-9 * b.choppedNorm2 &&
                       std::abs(a.reducedNorm2 - b.reducedNorm2) <= 1e-9 * std::abs(b.reducedNorm2);
    runs.push_back({{"entries", size},
                    {"fused_seconds", fusedSeconds[middle]},
                    {"naive_seconds", naiveSeconds[middle]},
                    {"ratio", ratios[middle]},
                    {"fused_gigabytes_per_second", bytes / fusedSeconds[middle] * 1e-9},
                    {"triad_gigabytes_per_second", stream * 1e-9},
                    {"results_agree", agree}});
    if (comm->getRank() == 0)
      std::cout << size << " entries: fused " << fusedSeconds[middle] << " s, naive " << naiveSeconds[middle]
                << " s a step, ratio " << ratios[middle] << ", " << bytes / fusedSeconds[middle] * 1e-9
                << " GB/s (triad " << stream * 1e-9 << ")" << (agree ? "" : ", RESULTS DIFFER") << "\n";
  }
  if (comm->getRank() == 0 && !output.empty()) {
    const nlohmann::json document = {
        {"benchmark", "qp_kernels"},
        {"harmos", {{"version", version()}, {"git", gitHash()}}},
        {"ranks", comm->getSize()},
        {"fused", {{"passes", 2}, {"reductions", 2}, {"reductions_beside_the_product", 1}}},
        {"naive", {{"passes", 12}, {"reductions", 6}}},
        {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
