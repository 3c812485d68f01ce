// SPDX-License-Identifier: MIT
// Eigenvalues and eigenvectors of symmetric 3x3 matrices.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace g4lidar {

[[nodiscard]] constexpr double squared(double a) noexcept { return a * a; }

using vector_3 = std::array<double, 3>;
using matrix_3 = std::array<vector_3, 3>;

/// `value[k]` and the unit vector `vector[k]`, in no order.
struct eigen_3 {
  vector_3 value;
  matrix_3 vector;
};

[[nodiscard]] constexpr double dot(const vector_3& a, const vector_3& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// a' m b.
[[nodiscard]] constexpr double product(const vector_3& a, const matrix_3& m,
                                       const vector_3& b) noexcept {
  return a[0] * dot(m[0], b) + a[1] * dot(m[1], b) + a[2] * dot(m[2], b);
}

/// Adds weight * a a' to `m`.
constexpr void add_square(matrix_3& m, const vector_3& a, double weight) noexcept {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m[i][j] += weight * a[i] * a[j];
}

/// By Jacobi rotations; of the finite symmetric matrix `m`.
[[nodiscard]] inline eigen_3 eigen_of(matrix_3 m) noexcept {
  matrix_3 v = {
      {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};  // its rows become the vectors
  constexpr int sweeps = 8;  // convergence is quadratic: 5 are sufficient for double precision
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const auto [p, q] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
      if (m[p][q] == 0.0) continue;
      const double ratio = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
      const double t = std::copysign(1.0 / (std::abs(ratio) + std::hypot(ratio, 1.0)), ratio);
      const double c = 1.0 / std::hypot(t, 1.0);
      const double s = t * c;
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = m[p][k];
        const double b = m[q][k];
        m[p][k] = c * a - s * b;
        m[q][k] = s * a + c * b;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = m[k][p];
        const double b = m[k][q];
        m[k][p] = c * a - s * b;
        m[k][q] = s * a + c * b;
        const double vp = v[p][k];
        v[p][k] = c * vp - s * v[q][k];
        v[q][k] = s * vp + c * v[q][k];
      }
    }
  }
  return {{m[0][0], m[1][1], m[2][2]}, v};
}

}  // namespace g4lidar
