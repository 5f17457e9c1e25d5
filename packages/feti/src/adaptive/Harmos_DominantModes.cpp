// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DominantModes.hpp"

#include "Harmos_Errors.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

constexpr int blockSize = 8;
constexpr int mostBlocks = 30;
// Of a Ritz value: whether a mode is left out does not depend on more.
constexpr double accuracy = 0.02;

double dot(const double* x, const double* y, std::size_t n) {
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    sum += x[k] * y[k];
  return sum;
}

// Vectors that are orthonormal in N, with their images Nv.
class Basis {
 public:
  Basis(const std::vector<double>& energy, int n) : energy_(energy), n_(static_cast<std::size_t>(n)) {}

  std::size_t columns() const { return vectors_.size() / n_; }
  const double* vector(std::size_t k) const { return vectors_.data() + k * n_; }
  const double* image(std::size_t k) const { return images_.data() + k * n_; }

  std::vector<double> applyN(const std::vector<double>& x) const {
    std::vector<double> y(x.size());
    const int n = static_cast<int>(n_);
    if (!x.empty())
      Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, n,
                                        static_cast<int>(x.size() / n_), n, 1.0, energy_.data(), n, x.data(),
                                        n, 0.0, y.data(), n);
    return y;
  }

  // Adds what is new in the columns of a block; returns how many.
  int add(const std::vector<double>& block) {
    int added = 0;
    for (std::size_t c = 0; c * n_ < block.size(); ++c) {
      std::vector<double> x(block.begin() + static_cast<std::ptrdiff_t>(c * n_),
                            block.begin() + static_cast<std::ptrdiff_t>((c + 1) * n_));
      std::vector<double> image = applyN(x);
      const double before = dot(x.data(), image.data(), n_);
      if (!(before > 0.0))
        continue;
      for (int pass = 0; pass < 2; ++pass) {
        for (std::size_t k = 0; k < columns(); ++k) {
          const double share = dot(this->image(k), x.data(), n_);
          for (std::size_t i = 0; i < n_; ++i)
            x[i] -= share * vector(k)[i];
        }
        image = applyN(x);
      }
      const double left = dot(x.data(), image.data(), n_);
      constexpr double rounding = 1e-20; // of squares
      if (!(left > rounding * before))
        continue;
      const double scale = 1.0 / std::sqrt(left);
      for (std::size_t i = 0; i < n_; ++i) {
        vectors_.push_back(scale * x[i]);
        images_.push_back(scale * image[i]);
      }
      ++added;
    }
    return added;
  }

 private:
  const std::vector<double>& energy_;
  std::size_t n_;
  std::vector<double> vectors_, images_;
};

// VᵀN S⁺ NV of a growing V, and its eigenpairs: Ritz values of S⁺N.
class Projection {
 public:
  static constexpr std::size_t most = static_cast<std::size_t>(mostBlocks) * blockSize;

  struct Pairs {
    std::vector<double> values;  // rising
    std::vector<double> vectors; // column after column
    std::vector<double> above(double threshold) const {
      std::vector<double> result;
      for (std::size_t k = values.size(); k-- > 0 && values[k] > threshold;)
        result.push_back(values[k]);
      return result;
    }
  };

  Projection() : matrix_(most * most, 0.0) {}

  void set(std::size_t i, std::size_t j, double value) {
    matrix_[j * most + i] = value;
    matrix_[i * most + j] = value;
  }

  Pairs solve(std::size_t dimension) const {
    Pairs pairs;
    pairs.values.resize(dimension);
    pairs.vectors.resize(dimension * dimension);
    for (std::size_t j = 0; j < dimension; ++j)
      std::copy_n(matrix_.begin() + static_cast<std::ptrdiff_t>(j * most), dimension,
                  pairs.vectors.begin() + static_cast<std::ptrdiff_t>(j * dimension));
    const int n = static_cast<int>(dimension);
    std::vector<double> work(34 * dimension);
    int info = 0;
    Teuchos::LAPACK<int, double>().SYEV('V', 'U', n, pairs.vectors.data(), n, pairs.values.data(),
                                        work.data(), static_cast<int>(work.size()), &info);
    if (info != 0)
      throw NumericalError("LAPACK's dsyev failed for the modes of a subdomain: info " +
                           std::to_string(info));
    return pairs;
  }

 private:
  std::vector<double> matrix_; // whole, of leading dimension most
};

// Whether two lists of the modes above the threshold are the same.
bool areSettled(const std::vector<double>& above, const std::vector<double>& before) {
  return std::equal(above.begin(), above.end(), before.begin(), before.end(),
                    [](double value, double last) { return std::abs(value - last) <= accuracy * value; });
}

// A number of [-1, 1] that depends on its place alone.
double noise(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15ULL;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9ULL;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebULL;
  seed ^= seed >> 31;
  return static_cast<double>(seed >> 11) * 0x1p-52 - 1.0;
}

} // namespace

DominantModes dominantModes(const std::vector<double>& energy, const BoundaryOperator& inverse,
                            const std::vector<double>& kernel, int kernelColumns, double threshold, int most,
                            std::uint64_t seed) {
  const int n = inverse.size();
  const auto size = static_cast<std::size_t>(n);
  HARMOS_REQUIRE(energy.size() == size * size &&
                     kernel.size() == size * static_cast<std::size_t>(kernelColumns),
                 "sizes of an eigenproblem");
  DominantModes result;
  Basis basis(energy, n);
  basis.add(kernel);
  const std::size_t first = basis.columns(); // beyond the kernel
  std::vector<double> block(size * blockSize);
  for (std::size_t k = 0; k < block.size(); ++k)
    block[k] = noise(seed * 0x100000001b3ULL + k);
  Projection projection;
  std::vector<double> before;
  for (int added = basis.add(block); added > 0;) {
    const std::size_t end = basis.columns(), begin = end - static_cast<std::size_t>(added);
    std::vector<double> load(basis.image(begin), basis.image(begin) + size * static_cast<std::size_t>(added));
    std::vector<double> next(load.size());
    inverse.apply(load.data(), next.data(), added);
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = first; i < end; ++i)
        projection.set(i - first, j - first, dot(basis.image(i), next.data() + (j - begin) * size, size));
    const std::size_t dimension = end - first;
    const Projection::Pairs pairs = projection.solve(dimension);
    std::vector<double> above = pairs.above(threshold);
    const bool isSettled = above.size() < dimension && dimension > 2 * blockSize && areSettled(above, before);
    before = above;
    const bool isFull = dimension + blockSize > Projection::most || end >= size;
    added = isSettled || isFull ? 0 : basis.add(next);
    if (added > 0)
      continue;
    above.resize(std::min(above.size(), static_cast<std::size_t>(most)));
    result.values = above;
    result.vectors.assign(above.size() * size, 0.0);
    for (std::size_t k = 0; k < above.size(); ++k)
      for (std::size_t j = 0; j < dimension; ++j) {
        const double share = pairs.vectors[(dimension - 1 - k) * dimension + j];
        for (std::size_t i = 0; i < size; ++i)
          result.vectors[k * size + i] += share * basis.vector(first + j)[i];
      }
  }
  return result;
}

} // namespace Harmos::feti
