// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace Harmos::feti {

/// Axes in which a subdomain's matrix and kernel are given, turned against those of its loads and rows: with
/// T = diag(Q, Q, ...) over its nodes, K = T K' Tᵀ and R = T R'. So a body that has turned keeps its factors,
/// and bodies that have turned by different angles share them.
///
/// Guarded by tests/unit/feti/pipeline/test_frames.cpp.
class Frame {
 public:
  /// @param axes Q, orthogonal; the leading block of as many components as a node has.
  Frame(const std::array<std::array<double, 3>, 3>& axes, int components)
      : axes_(axes), components_(static_cast<std::size_t>(components)) {}

  int components() const { return static_cast<int>(components_); }
  double operator()(std::size_t a, std::size_t b) const { return axes_[a][b]; }
  bool operator==(const Frame& other) const {
    return axes_ == other.axes_ && components_ == other.components_;
  }

  /// v ← Tᵀv, into the frame; and back, v ← Tv.
  void enter(std::vector<double>& v) const { turn(v, true); }
  void leave(std::vector<double>& v) const { turn(v, false); }

 private:
  void turn(std::vector<double>& v, bool transposed) const {
    std::array<double, 3> before{};
    for (std::size_t k = 0; k < v.size(); k += components_) {
      for (std::size_t a = 0; a < components_; ++a)
        before[a] = v[k + a];
      for (std::size_t a = 0; a < components_; ++a) {
        v[k + a] = 0.0;
        for (std::size_t b = 0; b < components_; ++b)
          v[k + a] += (transposed ? axes_[b][a] : axes_[a][b]) * before[b];
      }
    }
  }

  std::array<std::array<double, 3>, 3> axes_;
  std::size_t components_;
};

} // namespace Harmos::feti
