// SPDX-License-Identifier: BSD-3-Clause

/// The dual operator F = BK⁺Bᵀ of the two-membrane model in each of its forms: set-up, product, what it moves
/// and computes, against what this machine can move and compute. Writes JSON; see README.md.

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FormChoice.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_BLAS.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_MultiVector.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>

using namespace Harmos;
using namespace Harmos::feti;

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Seconds of a call on the slowest rank: the median of some.
template<class Call>
double timed(const Teuchos::Comm<int>& comm, int repetitions, int calls, Call&& call) {
  std::vector<double> seconds;
  call(); // first touch
  for (int r = 0; r < repetitions; ++r) {
    comm.barrier();
    const double start = now();
    for (int k = 0; k < calls; ++k)
      call();
    seconds.push_back(globalMax(comm, now() - start) / calls);
  }
  return median(seconds);
}

// Bytes a second that memory yields to all ranks together: the larger of reading one array and of STREAM's
// triad, in which the store reads its line first.
double streamPeak(const Teuchos::Comm<int>& comm) {
  const std::size_t n = std::size_t{1} << 25;
  std::vector<double> a(n, 1.0), b(n, 1.0), c(n, 2.0);
  double sums[8] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const double reading = timed(comm, 7, 1, [&] {
    double s[8] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < n; i += 8) {
      __builtin_prefetch(&a[std::min(i + 512, n - 8)]);
      for (std::size_t k = 0; k < 8; ++k)
        s[k] += a[i + k];
    }
    std::copy(s, s + 8, sums);
  });
  const double triad = timed(comm, 7, 1, [&] {
    for (std::size_t i = 0; i < n; ++i)
      a[i] = b[i] + 0.5 * c[i];
  });
  const double bytes = 8.0 * static_cast<double>(n) * comm.getSize();
  return sums[0] + a[n / 2] < 0.0 ? 0.0 : std::max(bytes / reading, 4.0 * bytes / triad);
}

// Operations a second of all ranks' matrix-matrix products of the shape that occurs.
template<class T>
double gemmPeak(const Teuchos::Comm<int>& comm, int n, int columns) {
  const auto size = static_cast<std::size_t>(n);
  const std::vector<T> a(size * size, T(1)), b(size * static_cast<std::size_t>(columns), T(1));
  std::vector<T> c(b.size());
  const double seconds = timed(comm, 7, 3, [&] {
    Teuchos::BLAS<int, T>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, n, columns, n, T(1), a.data(), n,
                                 b.data(), n, T(0), c.data(), n);
  });
  return 2.0 * n * n * columns * comm.getSize() / seconds;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');)
    parts.push_back(part);
  return parts;
}

} // namespace

int main(int argc, char** argv) {
  Tpetra::ScopeGuard guard(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  CLI::App app("The dual operator in its forms");
  int s = 8, repetitions = 5;
  std::vector<int> sizes = {32, 128};
  std::string forms = "condensed,implicit", output;
  bool unshared = true;
  app.add_option("--subdomains", s, "subdomains per side of a membrane");
  app.add_option("--sizes", sizes, "elements per subdomain side")->delimiter(',');
  app.add_option("--forms", forms);
  app.add_option("--unshared", unshared, "also without sharing");
  app.add_option("--repetitions", repetitions);
  app.add_option("--output", output, "a JSON file");
  CLI11_PARSE(app, argc, argv);

  nlohmann::json runs = nlohmann::json::array();
  const double stream = streamPeak(*comm);
  for (const int n : sizes) {
    const TestModel model = testModel(s, n);
    const SubdomainSystem system(comm, model.subdomains, DirichletForm::Primal);
    const Constraints constraints(system, model.rows);
    for (const std::string& form : split(forms))
      for (const bool share : {true, false})
        for (const Precision precision : {Precision::Double, Precision::Single}) {
          if (!share && !unshared)
            continue;
          LocalInverseOptions options;
          options.form = form == "implicit" ? DualForm::Implicit : DualForm::Condensed;
          options.share = share;
          options.precision = precision;
          comm->barrier();
          const double start = now();
          const LocalInverses inverses = makeLocalInverses(system, constraints, options);
          const DualOperator dualOperator(constraints, inverses);
          const double setup = globalMax(*comm, now() - start);
          FormLimits limits;
          limits.form = options.form;
          limits.preconditioner = PreconditionerKind::None;
          limits.budgetMiB = 1e9; // for an analysis in any case
          FactorizationContext context;
          const FormChoice expected = chooseForm(system, constraints, options, limits, context);
          const FormPrediction& prediction = expected.of(expected.forms);

          MultiVector x(constraints.rowMap(), 1), y(constraints.rowMap(), 1);
          x.putScalar(1.0);
          const double estimate = timed(*comm, 1, 1, [&] { dualOperator.apply(x, y); });
          const int calls = std::clamp(static_cast<int>(0.1 / estimate), 1, 200);
          const double product = timed(*comm, repetitions, calls, [&] { dualOperator.apply(x, y); });
          double bytes = 0.0, flops = 0.0;
          int columns = 1, order = 1;
          for (const SubdomainSum::Group& group : dualOperator.groups()) {
            bytes += group.op->bytesRead(group.members);
            flops += group.op->flops() * group.members;
            columns = std::max(columns, group.members);
            order = std::max(order, group.op->size());
          }
          bytes = globalSum(*comm, bytes);
          flops = globalSum(*comm, flops);
          const double gemm = precision == Precision::Single ? gemmPeak<float>(*comm, order, columns)
                                                             : gemmPeak<double>(*comm, order, columns);
          runs.push_back({{"subdomains_per_side", s},
                          {"elements_per_subdomain_side", n},
                          {"form", form},
                          {"shared", share},
                          {"precision", precision == Precision::Single ? "single" : "double"},
                          {"factorizations",
                           globalSum(*comm, static_cast<long long>(inverses.distinctFactorizations()))},
                          {"setup_seconds", setup},
                          {"product_seconds", product},
                          {"expected_setup_seconds", prediction.setupSeconds},
                          {"expected_product_seconds", prediction.productSeconds},
                          {"megabytes_read", bytes * 1e-6},
                          {"gigaflops_per_second", flops / product * 1e-9},
                          {"gigabytes_per_second", bytes / product * 1e-9},
                          {"fraction_of_gemm_peak", flops / product / gemm},
                          {"fraction_of_stream_peak", bytes / product / stream}});
          if (comm->getRank() == 0)
            std::cout << "S = " << s << ", N = " << n << ", " << form << (share ? ", shared" : ", not shared")
                      << (precision == Precision::Single ? ", single: " : ", double: ") << "set-up " << setup
                      << " s (expected " << prediction.setupSeconds << "), product " << product
                      << " s (expected " << prediction.productSeconds << "), " << flops / product * 1e-9
                      << " GFLOP/s (" << flops / product / gemm << " of GEMM), " << bytes / product * 1e-9
                      << " GB/s (" << bytes / product / stream << " of STREAM)" << std::endl;
        }
  }
  if (comm->getRank() == 0 && !output.empty()) {
    const nlohmann::json document = {{"benchmark", "dual_operator"},
                                     {"harmos", {{"version", version()}, {"git", gitHash()}}},
                                     {"ranks", comm->getSize()},
                                     {"stream_gigabytes_per_second", stream * 1e-9},
                                     {"runs", runs}};
    std::ofstream(output) << document.dump(2) << "\n";
  }
  return 0;
}
