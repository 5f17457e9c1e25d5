// SPDX-License-Identifier: BSD-3-Clause

// The product of Harmos_PackedSymmetric.cpp, which includes this file once for each instruction set.

// Four numbers in a vector register: an extension that GCC and clang share.
using Four [[gnu::vector_size(32)]] = double;
using FourSingle [[gnu::vector_size(16)]] = float;

#define HARMOS_INLINE inline __attribute__((always_inline))

HARMOS_INLINE Four load(const double* p) {
  Four v;
  std::memcpy(&v, p, sizeof(v));
  return v;
}
HARMOS_INLINE Four load(const float* p) {
  FourSingle v;
  std::memcpy(&v, p, sizeof(v));
  return __builtin_convertvector(v, Four);
}
HARMOS_INLINE void store(const Four& v, double* p) {
  std::memcpy(p, &v, sizeof(v));
}
HARMOS_INLINE double sum(const Four& v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

template<class T>
void multiply(const T* a, std::size_t n, const double* x, double* y) {
  const std::size_t length = (n + width - 1) / width * width;
  std::fill(y, y + length, 0.0);
  for (std::size_t j = 0; j < length; j += width) {
    const double x0 = x[j], x1 = x[j + 1], x2 = x[j + 2], x3 = x[j + 3];
    // The diagonal block is whole: only its rows.
    store(load(y + j) + load(a) * x0 + load(a + 4) * x1 + load(a + 8) * x2 + load(a + 12) * x3, y + j);
    a += tile;
    Four s0 = {}, s1 = {}, s2 = {}, s3 = {};
    for (std::size_t i = j + width; i < length; i += width, a += tile) {
      __builtin_prefetch(a + ahead * tile);
      if constexpr (sizeof(T) == sizeof(double))
        __builtin_prefetch(a + ahead * tile + tile / 2);
      const Four b0 = load(a), b1 = load(a + 4), b2 = load(a + 8), b3 = load(a + 12), xi = load(x + i);
      store(load(y + i) + (b0 * x0 + b1 * x1) + (b2 * x2 + b3 * x3), y + i);
      s0 += b0 * xi;
      s1 += b1 * xi;
      s2 += b2 * xi;
      s3 += b3 * xi;
    }
    y[j] += sum(s0);
    y[j + 1] += sum(s1);
    y[j + 2] += sum(s2);
    y[j + 3] += sum(s3);
  }
}

#undef HARMOS_INLINE
