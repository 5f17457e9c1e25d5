// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mumps.hpp"

#include "Harmos_Errors.hpp"

#include <dmumps_c.h>

namespace Harmos::feti {
namespace {

constexpr int jobInitialise = -1, jobEnd = -2, jobAnalyse = 1, jobFactorize = 2, jobSolve = 3;

std::string sentence(int code, int detail) {
  const std::string number = std::to_string(detail);
  switch (code) {
  case -1:
    return "an error on rank " + number + " of the factorisation's communicator";
  case -5:
  case -7:
  case -13:
    return "it could not allocate memory (" + number +
           ", in millions if negative); use more ranks, smaller subdomains or a coarser mesh";
  case -6:
    return "the matrix is structurally singular (structural rank " + number +
           "); look for a node that no element uses, or a material of zero stiffness";
  case -8:
  case -9:
    return "its workspace is too small by " + number + " entries even after it was enlarged";
  case -10:
    return "the matrix is numerically singular (" + number +
           " pivots found); the subdomain has more rigid motions than its kernel says: look for a mechanism, "
           "a "
           "hinge, or parts that are not connected";
  case -16:
    return "the order of the matrix, " + number + ", is out of range";
  case -22:
    return "an array (number " + number + ") is missing";
  case -40:
    return "the matrix is not positive definite; the subdomain has more rigid motions than its kernel says "
           "(a "
           "mechanism, a hinge, parts that are not connected), or a material has a negative stiffness";
  case -90:
    return "an out-of-core file could not be written or read";
  default:
    return "see the MUMPS users' guide for INFOG(1) = " + std::to_string(code);
  }
}

} // namespace

struct Mumps::Data {
  DMUMPS_STRUC_C mumps{};
  std::vector<int> rows, columns;
  std::vector<double> values;
  bool isRoot = false;
};

std::string Mumps::explain(int code, int detail) {
  return "MUMPS: " + sentence(code, detail) + " [INFOG(1) = " + std::to_string(code) +
         ", INFOG(2) = " + std::to_string(detail) + "]";
}

Mumps::Mumps(MPI_Comm comm, Symmetry symmetry) : data_(std::make_unique<Data>()) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  data_->isRoot = rank == 0;
  DMUMPS_STRUC_C& mumps = data_->mumps;
  mumps.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(comm));
  mumps.sym = static_cast<MUMPS_INT>(symmetry);
  mumps.par = 1; // the root works too
  call(jobInitialise);
  // Nothing on standard output: errors become exceptions.
  for (int stream : {0, 1, 2})
    mumps.icntl[stream] = -1;
  mumps.icntl[3] = 0;
}

Mumps::~Mumps() {
  data_->mumps.job = jobEnd;
  dmumps_c(&data_->mumps);
}

void Mumps::call(int job) {
  DMUMPS_STRUC_C& mumps = data_->mumps;
  constexpr int mostEnlargements = 4;
  for (int attempt = 0;; ++attempt) {
    mumps.job = job;
    dmumps_c(&mumps);
    const int code = mumps.infog[0], detail = mumps.infog[1];
    if (code > 0)
      warnings_.push_back("MUMPS warned with INFOG(1) = " + std::to_string(code));
    if (code >= 0)
      return;
    if ((code == -8 || code == -9) && job == jobFactorize && attempt < mostEnlargements) {
      mumps.icntl[13] = 2 * mumps.icntl[13] + 20; // workspace relaxation in per cent
      continue;
    }
    const ErrorData data = {{"infog1", std::to_string(code)}, {"infog2", std::to_string(detail)}};
    if (code == -6 || code == -10 || code == -40)
      throw NumericalError(explain(code, detail), data);
    throw InternalError(explain(code, detail), data);
  }
}

void Mumps::analyse(int order, std::vector<int> rows, std::vector<int> columns) {
  DMUMPS_STRUC_C& mumps = data_->mumps;
  data_->rows = std::move(rows);
  data_->columns = std::move(columns);
  if (data_->isRoot) {
    mumps.n = order;
    mumps.nnz = static_cast<MUMPS_INT8>(data_->rows.size());
    mumps.irn = data_->rows.data();
    mumps.jcn = data_->columns.data();
  }
  mumps.icntl[6] = 5;  // METIS; MUMPS falls back to another ordering where it was built without it
  mumps.icntl[27] = 1; // sequential analysis
  call(jobAnalyse);
}

void Mumps::factorize(std::vector<double> values) {
  DMUMPS_STRUC_C& mumps = data_->mumps;
  data_->values = std::move(values);
  if (data_->isRoot)
    mumps.a = data_->values.data();
  call(jobFactorize);
  // MUMPS factorises an indefinite matrix with SYM = 1 without a word; the count of negative pivots tells.
  const int negative = mumps.infog[11];
  if (mumps.sym == static_cast<MUMPS_INT>(Symmetry::PositiveDefinite) && negative > 0)
    throw NumericalError(explain(-40, negative), {{"infog1", "-40"}, {"infog2", std::to_string(negative)}});
  // The factors are complete: a solve without iterative refinement does not read the matrix again.
  data_->values = {};
  mumps.a = nullptr;
  // Sizes above 2^31 are given in millions with a negative sign.
  const double entries = mumps.infog[28];
  statistics_.factorEntries = entries < 0 ? -1e6 * entries : entries;
  statistics_.factorizationFlops = mumps.rinfog[2];
  statistics_.memoryMiB = mumps.infog[21];
}

void Mumps::solve(double* rightHandSides, int count) {
  DMUMPS_STRUC_C& mumps = data_->mumps;
  if (data_->isRoot) {
    mumps.rhs = rightHandSides;
    mumps.nrhs = count;
    mumps.lrhs = mumps.n;
  }
  call(jobSolve);
}

} // namespace Harmos::feti
