// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Mumps.hpp"

#include "Harmos_Errors.hpp"

#include <dmumps_c.h>
#include <smumps_c.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sys/mman.h>
#include <type_traits>
#include <unistd.h>

namespace Harmos::feti {
namespace {

constexpr int jobInitialise = -1, jobEnd = -2, jobAnalyse = 1, jobFactorize = 2, jobSolve = 3;

std::string sentence(int code, int detail) {
  const std::string number = std::to_string(detail);
  switch (code) {
  case -1:
    return "an error on rank " + number + " of the factorisation's communicator";
  case -2:
    return "the number of entries, " + number + ", is out of range";
  case -3:
    return "a phase was called before the one it needs: analyse, factorize and solve in this order";
  case -4:
    return "the given ordering is no permutation (entry " + number +
           "); give each row a unique position or use another ordering";
  case -5:
  case -7:
  case -13:
    return "it could not allocate memory (" + number +
           ", in millions if negative); use more ranks, smaller subdomains or a coarser mesh";
  case -6:
    return "the matrix is structurally singular (structural rank " + number +
           "); check for a node without elements or a material of zero stiffness";
  case -8:
  case -9:
  case -11:
  case -12:
  case -14:
  case -15:
  case -17:
  case -18:
  case -20:
    return "its workspace is too small by " + number + " entries even after it was enlarged";
  case -10:
    return "the matrix is numerically singular (" + number +
           " pivots found); the subdomain has more zero-energy modes than its kernel: check for a mechanism, "
           "a hinge or unconnected parts";
  case -16:
    return "the order of the matrix, " + number + ", is out of range";
  case -19:
    return "the memory limit is too small by " + number +
           " entries (in millions if negative); raise it, or use smaller subdomains";
  case -22:
    return "an array (number " + number + ") is missing";
  case -40:
    return "the matrix is not positive definite; the subdomain has more zero-energy modes than its kernel (a "
           "mechanism, a hinge, unconnected parts) or a material with negative stiffness";
  case -51:
    return "the matrix has too many entries for 32-bit graphs (" + number +
           "); use smaller subdomains, or the ordering \"AMD\"";
  case -52:
    return "the ordering library was built for other integers; use the ordering \"AMD\"";
  case -90:
    return "an out-of-core file could not be written or read";
  default:
    return "see the MUMPS users' guide for INFOG(1) = " + std::to_string(code);
  }
}

// What differs between dmumps_c and smumps_c.
struct DoubleKind {
  using Structure = DMUMPS_STRUC_C;
  using Value = double;
  static void call(Structure& s) { dmumps_c(&s); }
};
struct SingleKind {
  using Structure = SMUMPS_STRUC_C;
  using Value = float;
  static void call(Structure& s) { smumps_c(&s); }
};

// Memory whose tail can be given back to the system while the rest stays where it is.
class Workspace {
 public:
  Workspace() = default;
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
  ~Workspace() { release(); }

  void* allocate(std::size_t bytes) {
    release();
    data_ = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (data_ == MAP_FAILED) {
      data_ = nullptr;
      throw InternalError("a factorisation could not allocate " + std::to_string(bytes >> 20) +
                          " MiB; use more ranks, smaller subdomains or a coarser mesh");
    }
    bytes_ = bytes;
    return data_;
  }

  /// Gives the pages beyond the first bytes back. They may be used again, as scratch.
  void keepOnly(std::size_t bytes) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t kept = (bytes + page - 1) / page * page;
    if (kept < bytes_)
      madvise(static_cast<char*>(data_) + kept, bytes_ - kept, MADV_DONTNEED);
  }

 private:
  void release() {
    if (data_ != nullptr)
      munmap(data_, bytes_);
    data_ = nullptr;
  }
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

// Sizes above 2^31 are given in millions with a negative sign.
double sizeFrom(int info) {
  return info < 0 ? -1e6 * info : info;
}

} // namespace

std::string Mumps::explain(int code, int detail) {
  return "MUMPS: " + sentence(code, detail) + " [INFOG(1) = " + std::to_string(code) +
         ", INFOG(2) = " + std::to_string(detail) + "]";
}

std::string Mumps::explainWarning(int code) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (code & 1)
    add("entries outside of the matrix were ignored: an index is out of range");
  if (code & 2)
    add("a solution is zero to rounding, its error was not estimated");
  if (code & 4)
    add("a null pivot was found or perturbed: the solution has no reliable digit in that direction");
  if (code & 8)
    add("iterative refinement did not reach its accuracy: the matrix is badly conditioned");
  if (text.empty())
    text = "see the MUMPS users' guide";
  return "MUMPS warned: " + text + " [INFOG(1) = " + std::to_string(code) + "]";
}

class Mumps::Engine {
 public:
  virtual ~Engine() = default;
  virtual void analyse(int order, std::vector<int> rows, std::vector<int> columns, std::vector<int> schurRows,
                       const std::vector<int>& position) = 0;
  virtual std::vector<int> ordering() const = 0;
  virtual void factorize(std::vector<double> values) = 0;
  virtual void refactorize(std::vector<int> rows, std::vector<int> columns, std::vector<double> values) = 0;
  virtual std::vector<double> schurComplement() = 0;
  /// @param stage ICNTL(26): 0 solve, 1 condense, 2 expand.
  virtual void solve(double* rightHandSides, double* reduced, int count, int stage) = 0;
  virtual std::vector<int> nullPivots() const = 0;

  Mumps::Statistics statistics;
  std::vector<std::string> warnings;
};

namespace {

template<class Kind>
class EngineOf : public Mumps::Engine {
  using Value = typename Kind::Value;
  static constexpr bool isDouble = std::is_same_v<Value, double>;

 public:
  EngineOf(MPI_Comm comm, const MumpsOptions& options) : options_(options), comm_(comm) {
    int rank = 0;
    MPI_Comm_rank(comm, &rank);
    isRoot_ = rank == 0;
    mumps_.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(comm));
    mumps_.sym = static_cast<MUMPS_INT>(options.symmetry);
    mumps_.par = 1; // the root works too
    call(jobInitialise);
    // Nothing on standard output: errors become exceptions.
    for (int stream : {1, 2, 3})
      icntl(stream) = -1;
    icntl(4) = 0;
    icntl(23) = options.memoryMiB;
    // Without pivoting and compression its size is known beforehand.
    int ranks = 1;
    MPI_Comm_size(comm, &ranks);
    if (options.isDistributed) {
      icntl(18) = 3;
      icntl(13) = 1;
      icntl(8) = 0;
    }
    ownsWorkspace_ = ranks == 1 && options.symmetry == MumpsOptions::Symmetry::PositiveDefinite &&
                     options.blockLowRank == 0.0 && options.memoryMiB == 0;
    if (options.nullPivotThreshold > 0.0) {
      icntl(24) = 1;
      // A positive CNTL(3) is relative to the norm of the scaled matrix. The default, 0, misses kernels.
      mumps_.cntl[2] = static_cast<Value>(options.nullPivotThreshold);
    }
    if (options.blockLowRank > 0.0) {
      icntl(35) = 2; // compressed factors are kept and used in the solves
      mumps_.cntl[6] = static_cast<Value>(options.blockLowRank);
    }
  }

  ~EngineOf() override {
    mumps_.job = jobEnd;
    Kind::call(mumps_);
  }

  void analyse(int order, std::vector<int> rows, std::vector<int> columns, std::vector<int> schurRows,
               const std::vector<int>& position) override {
    checkSchurRows(order, schurRows);
    given_ = {std::move(rows), std::move(columns), position};
    analysedEntries_ = given_.rows.size();
    schurRows_ = std::move(schurRows);
    for (int& row : schurRows_)
      ++row;
    order_ = order;
    setEntries();
    if (isRoot_) {
      mumps_.n = order;
      mumps_.perm_in = position.empty() ? nullptr : given_.position.data();
    }
    icntl(7) = static_cast<MUMPS_INT>(position.empty() && options_.ordering == MumpsOptions::Ordering::Given
                                          ? MumpsOptions::Ordering::Metis
                                          : options_.ordering);
    icntl(28) = 1; // sequential analysis
    if (schurSize() > 0) {
      icntl(19) = 1; // the Schur complement whole, on the root
      mumps_.size_schur = schurSize();
      mumps_.listvar_schur = schurRows_.data();
    } else {
      icntl(19) = 0;
      mumps_.size_schur = 0;
      mumps_.listvar_schur = nullptr;
    }
    call(jobAnalyse);
    ++statistics.analyses;
    workspaceEntries_ = sizeFrom(mumps_.info[7]);
    statistics.factorEntries = sizeFrom(mumps_.infog[19]);
    statistics.factorizationFlops = static_cast<double>(mumps_.rinfog[0]);
    statistics.memoryMiB = mumps_.infog[16];
  }

  std::vector<int> ordering() const override {
    HARMOS_REQUIRE(!isRoot_ || mumps_.sym_perm != nullptr, "an ordering is known after the analysis only");
    return isRoot_ ? std::vector<int>(mumps_.sym_perm, mumps_.sym_perm + order_) : std::vector<int>();
  }

  void factorize(std::vector<double> values) override {
    HARMOS_REQUIRE(!given_.rows.empty() || !isRoot_ || options_.isDistributed,
                   "a matrix is factored once, after its analysis");
    scale(values);
    std::vector<Value> converted;
    if constexpr (isDouble)
      converted = std::move(values);
    else
      converted.assign(values.begin(), values.end());
    (options_.isDistributed ? mumps_.a_loc : mumps_.a) = converted.data();
    if (isRoot_) {
      schur_.assign(static_cast<std::size_t>(schurSize()) * static_cast<std::size_t>(schurSize()), Value(0));
      mumps_.schur = schur_.data();
    }
    if (ownsWorkspace_)
      provideWorkspace(workspaceEntries_);
    call(jobFactorize);
    ++statistics.factorizations;
    // The factors stand at the beginning, the rest was needed while they were made: often as much again.
    if (ownsWorkspace_)
      workspace_.keepOnly(static_cast<std::size_t>(sizeFrom(mumps_.info[8])) * sizeof(Value));
    // MUMPS factorises an indefinite matrix with SYM = 1 without a word; the count of negative pivots tells.
    const int negative = mumps_.infog[11];
    if (options_.symmetry == MumpsOptions::Symmetry::PositiveDefinite && negative > 0)
      throw NumericalError(Mumps::explain(-40, negative),
                           {{"infog1", "-40"}, {"infog2", std::to_string(negative)}});
    isFactored_ = true;
    // The factors are complete: a solve without iterative refinement does not read the matrix again.
    mumps_.a = mumps_.a_loc = nullptr;
    mumps_.irn = mumps_.jcn = mumps_.irn_loc = mumps_.jcn_loc = nullptr;
    given_ = {};
    statistics.factorEntries = sizeFrom(mumps_.infog[28]);
    statistics.factorizationFlops = static_cast<double>(mumps_.rinfog[2]);
    statistics.memoryMiB = mumps_.infog[21];
  }

  void refactorize(std::vector<int> rows, std::vector<int> columns, std::vector<double> values) override {
    // Also after a factorisation that failed: the analysis is still good.
    HARMOS_REQUIRE(statistics.analyses > 0, "a matrix is factored again after its analysis");
    if ((isRoot_ || options_.isDistributed) &&
        (rows.size() != analysedEntries_ || values.size() != analysedEntries_))
      throw InputError("a matrix with " + std::to_string(values.size()) +
                       " entries does not match the analysis, which has " + std::to_string(analysedEntries_) +
                       "; repeat the analysis for the new graph");
    given_ = {std::move(rows), std::move(columns), {}};
    setEntries();
    isFactored_ = false;
    condensed_ = 0;
    factorize(std::move(values));
  }

  std::vector<double> schurComplement() override {
    std::vector<double> s(schur_.begin(), schur_.end());
    schur_ = {};
    for (double& entry : s)
      entry /= scale_;
    const auto n = static_cast<std::size_t>(schurSize());
    // By rows. Of symmetric matrices MUMPS gives one triangle.
    for (std::size_t i = 0; i < n && !s.empty(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (options_.symmetry == MumpsOptions::Symmetry::General)
          std::swap(s[i * n + j], s[j * n + i]);
        else
          s[j * n + i] = s[i * n + j];
      }
    return s;
  }

  void solve(double* rightHandSides, double* reduced, int count, int stage) override {
    std::vector<Value> rhs, red; // copies for single precision
    const std::size_t length = static_cast<std::size_t>(order_) * static_cast<std::size_t>(count);
    const std::size_t reducedLength = static_cast<std::size_t>(schurSize()) * static_cast<std::size_t>(count);
    HARMOS_REQUIRE(isFactored_, "a solve needs a factorisation");
    HARMOS_REQUIRE(stage != 2 || count == condensed_,
                   "expand() is for the right-hand sides of the last condense()");
    condensed_ = stage == 1 ? count : 0;
    if (isRoot_) {
      for (std::size_t k = 0; stage != 2 && k < length; ++k)
        rightHandSides[k] *= scale_;
      if constexpr (isDouble) {
        mumps_.rhs = rightHandSides;
        mumps_.redrhs = reduced;
      } else {
        rhs.assign(rightHandSides, rightHandSides + length);
        red.resize(reducedLength);
        if (stage == 2)
          std::copy(reduced, reduced + reducedLength, red.begin());
        mumps_.rhs = rhs.data();
        mumps_.redrhs = red.data();
      }
      mumps_.nrhs = count;
      mumps_.lrhs = mumps_.n;
      mumps_.lredrhs = schurSize();
    }
    icntl(26) = stage;
    call(jobSolve);
    if (!isDouble && isRoot_) {
      std::copy(rhs.begin(), rhs.end(), rightHandSides);
      if (stage == 1)
        std::copy(red.begin(), red.end(), reduced);
    }
    for (std::size_t k = 0; isRoot_ && stage == 1 && k < reducedLength; ++k)
      reduced[k] /= scale_;
  }

  std::vector<int> nullPivots() const override {
    std::vector<int> result;
    if (isRoot_ && mumps_.pivnul_list != nullptr)
      for (int k = 0; k < mumps_.infog[27]; ++k)
        result.push_back(mumps_.pivnul_list[k] - 1);
    return result;
  }

 private:
  int schurSize() const { return static_cast<int>(schurRows_.size()); }
  MUMPS_INT& icntl(int number) { return mumps_.icntl[number - 1]; }

  static void checkSchurRows(int order, std::vector<int> rows) {
    std::sort(rows.begin(), rows.end());
    if (!rows.empty() && (rows.front() < 0 || rows.back() >= order))
      throw InputError("a Schur row is out of range: rows are 0 to " + std::to_string(order - 1));
    if (std::adjacent_find(rows.begin(), rows.end()) != rows.end())
      throw InputError("a Schur row is named twice");
    if (!rows.empty() && static_cast<int>(rows.size()) == order)
      throw InputError("all rows are Schur rows, so no row is left to eliminate; the Schur complement is the "
                       "matrix itself");
  }

  // By a power of two, so that the largest entry is about one. MUMPS takes pivots below some absolute size
  // for null and changes them, and single precision has a short range.
  void scale(std::vector<double>& values) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double largest = 0.0;
    for (double value : values)
      largest = std::isfinite(value) ? std::max(largest, std::abs(value)) : infinity;
    if (options_.isDistributed) {
      const double mine = largest;
      MPI_Allreduce(&mine, &largest, 1, MPI_DOUBLE, MPI_MAX, comm_);
    }
    if (std::isinf(largest))
      throw InputError("a matrix to be factored has a non-finite entry; check its assembly");
    scale_ = largest > 0.0 ? std::exp2(-std::floor(std::log2(largest))) : 1.0;
    // Beyond the range of numbers there is no such power.
    if (!std::isfinite(scale_) || scale_ == 0.0)
      scale_ = 1.0;
    for (double& value : values)
      value *= scale_;
    // A negative CNTL(3) is absolute.
    if (options_.isDistributed && options_.nullPivotThreshold > 0.0)
      mumps_.cntl[2] = static_cast<Value>(-options_.nullPivotThreshold * largest * scale_);
  }

  void setEntries() {
    if (options_.isDistributed) {
      mumps_.nnz_loc = static_cast<MUMPS_INT8>(given_.rows.size());
      mumps_.irn_loc = given_.rows.data();
      mumps_.jcn_loc = given_.columns.data();
    } else if (isRoot_) {
      mumps_.nnz = static_cast<MUMPS_INT8>(given_.rows.size());
      mumps_.irn = given_.rows.data();
      mumps_.jcn = given_.columns.data();
    }
  }

  // MUMPS' main array, of the given number of entries.
  void provideWorkspace(double entries) {
    // Larger ones are told in millions with a negative sign.
    constexpr double mostEntries = 2e9;
    const bool large = entries > mostEntries;
    const double length = large ? 1e6 * std::ceil(1e-6 * entries) : std::ceil(entries);
    mumps_.wk_user =
        static_cast<Value*>(workspace_.allocate(static_cast<std::size_t>(length) * sizeof(Value)));
    mumps_.lwk_user = static_cast<MUMPS_INT>(large ? -1e-6 * length : length);
  }

  void call(int job) {
    constexpr int mostEnlargements = 4;
    for (int attempt = 0;; ++attempt) {
      mumps_.job = job;
      Kind::call(mumps_);
      const int code = mumps_.infog[0], detail = mumps_.infog[1];
      if (code > 0)
        warnings.push_back(Mumps::explainWarning(code));
      if (code >= 0)
        return;
      if ((code == -8 || code == -9) && job == jobFactorize && attempt < mostEnlargements) {
        icntl(14) = 2 * icntl(14) + 20; // workspace relaxation in per cent
        if (ownsWorkspace_)
          provideWorkspace(workspaceEntries_ * (1.0 + 0.01 * icntl(14)));
        continue;
      }
      const ErrorData data = {{"infog1", std::to_string(code)}, {"infog2", std::to_string(detail)}};
      if (code == -6 || code == -10 || code == -40)
        throw NumericalError(Mumps::explain(code, detail), data);
      throw InternalError(Mumps::explain(code, detail), data);
    }
  }

  MumpsOptions options_;
  MPI_Comm comm_;
  typename Kind::Structure mumps_{};
  struct Given {
    std::vector<int> rows, columns, position;
  };
  Given given_;                // until the matrix is factored
  std::vector<int> schurRows_; // one-based
  std::vector<Value> schur_;
  int order_ = 0;
  std::size_t analysedEntries_ = 0;
  double workspaceEntries_ = 0.0; // INFO(8) of the analysis
  bool isRoot_ = false;
  Workspace workspace_;
  bool ownsWorkspace_ = false;
  double scale_ = 1.0; // of the factored matrix
  bool isFactored_ = false;
  int condensed_ = 0; // right-hand sides of the last condense()
};

} // namespace

Mumps::Mumps(MPI_Comm comm, const MumpsOptions& options) {
  if (options.precision == MumpsOptions::Precision::Double)
    engine_ = std::make_unique<EngineOf<DoubleKind>>(comm, options);
  else
    engine_ = std::make_unique<EngineOf<SingleKind>>(comm, options);
}

Mumps::~Mumps() = default;

void Mumps::analyse(int order, std::vector<int> rows, std::vector<int> columns, std::vector<int> schurRows,
                    const std::vector<int>& position) {
  engine_->analyse(order, std::move(rows), std::move(columns), std::move(schurRows), position);
}

std::vector<int> Mumps::ordering() const {
  return engine_->ordering();
}

void Mumps::factorize(std::vector<double> values) {
  engine_->factorize(std::move(values));
}

void Mumps::refactorize(std::vector<int> rows, std::vector<int> columns, std::vector<double> values) {
  engine_->refactorize(std::move(rows), std::move(columns), std::move(values));
}

std::vector<double> Mumps::schurComplement() {
  return engine_->schurComplement();
}

void Mumps::solve(double* rightHandSides, int count) {
  engine_->solve(rightHandSides, nullptr, count, 0);
}

void Mumps::condense(double* rightHandSides, double* reduced, int count) {
  engine_->solve(rightHandSides, reduced, count, 1);
}

void Mumps::expand(double* rightHandSides, double* reduced, int count) {
  engine_->solve(rightHandSides, reduced, count, 2);
}

std::vector<int> Mumps::nullPivots() const {
  return engine_->nullPivots();
}

const Mumps::Statistics& Mumps::statistics() const {
  return engine_->statistics;
}

const std::vector<std::string>& Mumps::warnings() const {
  return engine_->warnings;
}

} // namespace Harmos::feti
