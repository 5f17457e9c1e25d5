// SPDX-License-Identifier: BSD-3-Clause
/// The QP layer with a vector type of one's own: nine functions beside what Belos asks for; see docs/qp.md.
#include <Harmos_BoundTraits.hpp>

#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>
#include <Teuchos_GlobalMPISession.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

/// A field on a grid of points: one value each.
struct Field {
  std::vector<double> values;
};

/// The stiffness matrix of a string, fixed at its ends: −u'' by central differences.
struct String {
  double h;
};

template<>
struct Harmos::qp::BoundTraits<double, Field> {
  static std::size_t length(const Field& v) { return v.values.size(); }
  static const double* read(const Field& v) { return v.values.data(); }
  static double* write(Field& v) { return v.values.data(); }
  static long long globalIndex(const Field&, std::size_t entry) { return static_cast<long long>(entry); }
  // Each rank has a problem of its own: there is nothing to be summed.
  static void sum(const Field&, double*, int) {}
  static void sumAndMin(const Field&, double*, int, double&) {}
  static double maximum(const Field&, double value) { return value; }
  static std::vector<double> gather(const Field& v) { return v.values; }
  static void scatter(const std::vector<double>& values, Field& v) { v.values = values; }
};

// What Belos asks for. The QP layer uses vectors of one column.
template<>
class Belos::MultiVecTraits<double, Field> {
  using Matrix = Teuchos::SerialDenseMatrix<int, double>;

 public:
  static Teuchos::RCP<Field> Clone(const Field& v, int) {
    return Teuchos::rcp(new Field{std::vector<double>(v.values.size(), 0.0)});
  }
  static Teuchos::RCP<Field> CloneCopy(const Field& v) { return Teuchos::rcp(new Field(v)); }
  static Teuchos::RCP<const Field> CloneView(const Field& v, const Teuchos::Range1D&) { return CloneCopy(v); }
  static void SetBlock(const Field& from, const Teuchos::Range1D&, Field& to) { to = from; }
  static std::ptrdiff_t GetGlobalLength(const Field& v) {
    return static_cast<std::ptrdiff_t>(v.values.size());
  }
  static int GetNumberVecs(const Field&) { return 1; }
  static void MvAddMv(double a, const Field& x, double b, const Field& y, Field& z) {
    for (std::size_t i = 0; i < z.values.size(); ++i)
      z.values[i] = (a == 0.0 ? 0.0 : a * x.values[i]) + (b == 0.0 ? 0.0 : b * y.values[i]);
  }
  static void MvTimesMatAddMv(double a, const Field& x, const Matrix& m, double b, Field& y) {
    MvAddMv(a * m(0, 0), x, b, y, y);
  }
  static void MvTransMv(double a, const Field& x, const Field& y, Matrix& m) {
    std::vector<double> product(1);
    MvDot(x, y, product);
    m(0, 0) = a * product[0];
  }
  static void MvScale(Field& v, double a) { MvAddMv(a, v, 0.0, v, v); }
  static void MvDot(const Field& x, const Field& y, std::vector<double>& products) {
    products[0] = 0.0;
    for (std::size_t i = 0; i < x.values.size(); ++i)
      products[0] += x.values[i] * y.values[i];
  }
  static void MvNorm(const Field& v, std::vector<double>& norms, NormType = TwoNorm) {
    MvDot(v, v, norms);
    norms[0] = std::sqrt(norms[0]);
  }
  static void Assign(const Field& from, Field& to) { to = from; }
  static void MvInit(Field& v, double a = 0.0) { std::fill(v.values.begin(), v.values.end(), a); }
};

template<>
class Belos::OperatorTraits<double, Field, String> {
 public:
  static void Apply(const String& a, const Field& x, Field& y, ETrans = NOTRANS) {
    const std::size_t n = x.values.size();
    for (std::size_t i = 0; i < n; ++i)
      y.values[i] =
          (2.0 * x.values[i] - (i > 0 ? x.values[i - 1] : 0.0) - (i + 1 < n ? x.values[i + 1] : 0.0)) / a.h;
  }
  static bool HasApplyTranspose(const String&) { return true; }
};

#include <Harmos_SolverFactory_def.hpp>

using namespace Harmos;

int main(int argc, char** argv) {
  const Teuchos::GlobalMPISession session(&argc, &argv, nullptr);
  // Pulled down by a load of one, above a table at −0.1: u = −x(2c − x)/2 up to where it touches with slope
  // zero, at c = √0.2.
  const std::size_t n = 999;
  const double h = 1.0 / static_cast<double>(n + 1), c = std::sqrt(0.2);
  const auto field = [n](double value) { return Teuchos::rcp(new Field{std::vector<double>(n, value)}); };
  const auto u = field(0.0);
  const auto problem =
      Teuchos::rcp(new qp::Problem<double, Field, String>(Teuchos::rcp(new String{h}), u, field(-h)));
  problem->setLowerBound(field(-0.1));
  if (!problem->setProblem()) {
    std::cout << problem->whyNotSet() << "\n";
    return 1;
  }
  const auto list = Teuchos::parameterList();
  list->set("Convergence Tolerance", 1e-10);
  const auto solver = qp::SolverFactory<double, Field, String>().create("MPRGP", list);
  solver->setProblem(problem);
  const qp::Result result = solver->solve();
  double error = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = h * static_cast<double>(i + 1), end = std::min(x, 1.0 - x);
    error = std::max(error, std::abs(u->values[i] + (end < c ? 0.5 * end * (2.0 * c - end) : 0.1)));
  }
  if (Teuchos::GlobalMPISession::getRank() == 0)
    std::cout << result.method << ": " << qp::toString(result.reason) << ", " << result.history.back().active
              << " points on the table, error " << (error < h * h ? "below" : "above") << " h²\n";
}
