// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PackedSymmetric.hpp"

#include "Harmos_WideRegisters.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace Harmos::feti::PackedSymmetric {
namespace {

constexpr std::size_t width = 4; // rows and columns of a tile
constexpr std::size_t tile = width * width;
// How far ahead of its use the stream is fetched, in tiles: some hundred nanoseconds' worth.
constexpr std::size_t ahead = 32;

namespace Portable {
#include "Harmos_PackedSymmetric_product.inc"
} // namespace Portable

#ifdef HARMOS_HAS_WIDE_REGISTERS
#pragma GCC push_options
#pragma GCC target("avx2,fma")
namespace Wide {
#include "Harmos_PackedSymmetric_product.inc"
} // namespace Wide
#pragma GCC pop_options
#else
namespace Wide = Portable;
#endif

template<class T>
void dispatch(const T* packed, std::size_t n, const double* x, double* y) {
  if (hasWideRegisters())
    Wide::multiply(packed, n, x, y);
  else
    Portable::multiply(packed, n, x, y);
}

} // namespace

int paddedLength(int n) {
  const int w = static_cast<int>(width);
  return (n + w - 1) / w * w;
}

template<class T>
std::vector<T> pack(const std::vector<double>& matrix, int n) {
  const auto size = static_cast<std::size_t>(n), length = static_cast<std::size_t>(paddedLength(n));
  std::vector<T> packed;
  packed.reserve(length * (length + width) / 2);
  for (std::size_t j = 0; j < length; j += width)
    for (std::size_t i = j; i < length; i += width)
      for (std::size_t c = j; c < j + width; ++c)
        for (std::size_t r = i; r < i + width; ++r)
          packed.push_back(c < size && r < size ? static_cast<T>(matrix[c * size + r]) : T(0));
  return packed;
}

template<class T>
std::vector<double> unpack(const std::vector<T>& packed, int n) {
  const auto size = static_cast<std::size_t>(n), length = static_cast<std::size_t>(paddedLength(n));
  std::vector<double> matrix(size * size);
  const T* next = packed.data();
  for (std::size_t j = 0; j < length; j += width)
    for (std::size_t i = j; i < length; i += width)
      for (std::size_t c = j; c < j + width; ++c)
        for (std::size_t r = i; r < i + width; ++r, ++next)
          if (c < size && r < size)
            matrix[c * size + r] = matrix[r * size + c] = static_cast<double>(*next);
  return matrix;
}

template std::vector<double> unpack<double>(const std::vector<double>&, int);
template std::vector<double> unpack<float>(const std::vector<float>&, int);
template std::vector<double> pack<double>(const std::vector<double>&, int);
template std::vector<float> pack<float>(const std::vector<double>&, int);

void multiply(const double* packed, int n, const double* x, double* y) {
  dispatch(packed, static_cast<std::size_t>(n), x, y);
}

void multiply(const float* packed, int n, const double* x, double* y) {
  dispatch(packed, static_cast<std::size_t>(n), x, y);
}

} // namespace Harmos::feti::PackedSymmetric
