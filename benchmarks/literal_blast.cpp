// SPDX-License-Identifier: GPL-3.0-or-later
// Algorithm 1 of the paper taken at its word, on one thread: for every two points of two strong curves and both
// senses, the stretches of length l0 that start there are compared by ICP, and extended by delta_l while they agree.
// It is the yardstick for the speed of core/matching/. It measures randomly chosen pairs of curves until a time
// budget is spent, and projects the time of all.
//
//   literal_blast CURVES.obj EDGE_LENGTH [L0 = 25 edges] [SECONDS = 10]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using Point = std::array<double, 3>;
using Polyline = std::vector<Point>;
using Matrix4 = std::array<std::array<double, 4>, 4>;

constexpr int kDeltaL = 5;         // edges by which a match is extended
constexpr int kIcpRounds = 10;     // at most
constexpr double kIcpGain = 1e-3;  // relative gain below which ICP stops

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double square(const Point& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

// Eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi rotations.
std::array<double, 4> jacobi_eigenvector(Matrix4 m) {
  Matrix4 v{};
  for (int i = 0; i < 4; ++i) v[i][i] = 1;
  for (int sweep = 0; sweep < 8; ++sweep) {
    double rest = 0, scale = 0;
    for (int p = 0; p < 4; ++p) {
      scale += m[p][p] * m[p][p];
      for (int q = p + 1; q < 4; ++q) rest += m[p][q] * m[p][q];
    }
    if (rest <= 1e-16 * scale) break;
    for (int p = 0; p < 4; ++p) {
      for (int q = p + 1; q < 4; ++q) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 4; ++k) {
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
        }
        for (int k = 0; k < 4; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
        }
        for (int k = 0; k < 4; ++k) {
          const double a = v[k][p], b = v[k][q];
          v[k][p] = c * a - s * b, v[k][q] = s * a + c * b;
        }
      }
    }
  }
  int top = 0;
  for (int i = 1; i < 4; ++i)
    if (m[i][i] > m[top][top]) top = i;
  return {v[0][top], v[1][top], v[2][top], v[3][top]};
}

// Eigenvector of the largest eigenvalue, found by Newton's method from above on the characteristic polynomial
// x^4 + c2 x^2 + c1 x + c0: a column of the adjugate of n - x. Where that vanishes (a straight stretch leaves the
// rotation about itself free), by Jacobi rotations.
std::array<double, 4> leading_eigenvector(const Matrix4& n, double c2, double c1, double above) {
  const double p01 = n[0][0] * n[1][1] - n[0][1] * n[0][1], p02 = n[0][0] * n[1][2] - n[0][2] * n[0][1];
  const double p03 = n[0][0] * n[1][3] - n[0][3] * n[0][1], p12 = n[0][1] * n[1][2] - n[0][2] * n[1][1];
  const double p13 = n[0][1] * n[1][3] - n[0][3] * n[1][1], p23 = n[0][2] * n[1][3] - n[0][3] * n[1][2];
  const double q01 = n[2][0] * n[3][1] - n[2][1] * n[3][0], q02 = n[2][0] * n[3][2] - n[2][2] * n[3][0];
  const double q03 = n[2][0] * n[3][3] - n[2][3] * n[3][0], q12 = n[2][1] * n[3][2] - n[2][2] * n[3][1];
  const double q13 = n[2][1] * n[3][3] - n[2][3] * n[3][1], q23 = n[2][2] * n[3][3] - n[2][3] * n[3][2];
  const double c0 = p01 * q23 - p02 * q13 + p03 * q12 + p12 * q03 - p13 * q02 + p23 * q01;
  double x = above;
  for (int i = 0; i < 30; ++i) {
    const double value = ((x * x + c2) * x + c1) * x + c0, slope = (4 * x * x + 2 * c2) * x + c1;
    if (slope <= 0) break;
    const double step = value / slope;
    x -= step;
    if (std::fabs(step) < 1e-9 * x) break;
  }
  Matrix4 m = n;
  for (int i = 0; i < 4; ++i) m[i][i] -= x;
  const auto minor = [&m](int r, int c) {
    int i[3], j[3];
    for (int k = 0, a = 0, b = 0; k < 4; ++k) {
      if (k != r) i[a++] = k;
      if (k != c) j[b++] = k;
    }
    const double d = m[i[0]][j[0]] * (m[i[1]][j[1]] * m[i[2]][j[2]] - m[i[1]][j[2]] * m[i[2]][j[1]]) -
                     m[i[0]][j[1]] * (m[i[1]][j[0]] * m[i[2]][j[2]] - m[i[1]][j[2]] * m[i[2]][j[0]]) +
                     m[i[0]][j[2]] * (m[i[1]][j[0]] * m[i[2]][j[1]] - m[i[1]][j[1]] * m[i[2]][j[0]]);
    return (r + c) % 2 ? -d : d;
  };
  const double tiny = 1e-5 * x * x * x;
  for (int column = 0; column < 4; ++column) {
    std::array<double, 4> v = {minor(0, column), minor(1, column), minor(2, column), minor(3, column)};
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    if (length <= tiny) continue;
    for (double& e : v) e /= length;
    return v;
  }
  return jacobi_eigenvector(n);
}

// Rotation that best takes a[k] onto b[k], both relative to their start (Horn's unit quaternion).
std::array<Point, 3> best_rotation(const Polyline& a, const Polyline& b) {
  double h[3][3] = {}, energy = 0, squares = 0;
  for (size_t k = 0; k < a.size(); ++k) {
    energy += square(a[k]) + square(b[k]);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) h[i][j] += a[k][i] * b[k][j];
  }
  for (const auto& row : h) squares += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
  const double det = h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1]) -
                     h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0]) +
                     h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
  const double yz = h[1][2] - h[2][1], zx = h[2][0] - h[0][2], xy = h[0][1] - h[1][0];
  const double sxy = h[0][1] + h[1][0], szx = h[2][0] + h[0][2], syz = h[1][2] + h[2][1];
  const Matrix4 n = {{{h[0][0] + h[1][1] + h[2][2], yz, zx, xy},
                      {yz, h[0][0] - h[1][1] - h[2][2], sxy, szx},
                      {zx, sxy, h[1][1] - h[0][0] - h[2][2], syz},
                      {xy, szx, syz, h[2][2] - h[0][0] - h[1][1]}}};
  const auto [w, x, y, z] = leading_eigenvector(n, -2 * squares, -8 * det, energy / 2);
  return {{{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}}};
}

// Mean distance of a stretch of `count` points to another after ICP that keeps the two starts together.
class Comparison {
 public:
  double operator()(const Point* from, const Point* onto, int sense, int count) {
    a_.resize(count), b_.resize(count), nearest_.resize(count);
    for (int k = 0; k < count; ++k) a_[k] = minus(from[k], from[0]), b_[k] = minus(onto[sense * k], onto[0]);
    nearest_ = b_;
    for (auto* v : {&x_, &y_, &z_, &away_}) v->resize(count);
    for (int k = 0; k < count; ++k) x_[k] = b_[k][0], y_[k] = b_[k][1], z_[k] = b_[k][2];
    double last = 1e300, mean = 0;
    for (int round = 0; round < kIcpRounds; ++round) {
      const auto r = best_rotation(a_, nearest_);
      mean = 0;
      for (int k = 0; k < count; ++k) {
        Point moved;
        for (int i = 0; i < 3; ++i) moved[i] = r[i][0] * a_[k][0] + r[i][1] * a_[k][1] + r[i][2] * a_[k][2];
        double least = 1e300;
        for (int l = 0; l < count; ++l) {  // two passes, so that the compiler can vectorise the first
          const double x = moved[0] - x_[l], y = moved[1] - y_[l], z = moved[2] - z_[l];
          away_[l] = x * x + y * y + z * z;
          least = away_[l] < least ? away_[l] : least;
        }
        int at = 0;
        while (away_[at] > least) ++at;
        nearest_[k] = b_[at];
        mean += std::sqrt(least);
      }
      mean /= count;
      if (last - mean < kIcpGain * last) break;
      last = mean;
    }
    return mean;
  }

 private:
  Polyline a_, b_, nearest_;
  std::vector<double> x_, y_, z_, away_;
};

// Points at equal arc length, as near to `step` apart as the ends allow.
Polyline resample(const Polyline& p, double step) {
  std::vector<double> s(p.size(), 0);
  for (size_t i = 1; i < p.size(); ++i) s[i] = s[i - 1] + std::sqrt(square(minus(p[i], p[i - 1])));
  const int edges = std::max(1L, std::lround(s.back() / step));
  Polyline out;
  size_t at = 0;
  for (int i = 0; i <= edges; ++i) {
    const double t = s.back() * i / edges;
    while (at + 2 < p.size() && s[at + 1] < t) ++at;
    const double length = s[at + 1] - s[at], u = length > 0 ? (t - s[at]) / length : 0;
    Point q;
    for (int k = 0; k < 3; ++k) q[k] = p[at][k] + u * (p[at + 1][k] - p[at][k]);
    out.push_back(q);
  }
  return out;
}

std::vector<Polyline> strong_curves(const char* path, double step, int l0) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(std::string(path) + ": cannot be read");
  std::vector<Point> vertices;
  std::vector<Polyline> curves;
  std::string line, word;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    in >> word;
    if (word == "v") {
      Point p;
      in >> p[0] >> p[1] >> p[2];
      vertices.push_back(p);
    } else if (word == "l") {
      Polyline curve;
      for (long index; in >> index;) curve.push_back(vertices.at(index - 1));
      if (curve.size() < 2) continue;
      curve = resample(curve, step);
      if (static_cast<int>(curve.size()) > l0) curves.push_back(std::move(curve));
    }
    word.clear();
  }
  return curves;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::cerr << "usage: literal_blast CURVES.obj EDGE_LENGTH [L0] [SECONDS]\n";
    return 2;
  }
  const double h = std::atof(argv[2]), budget = argc > 4 ? std::atof(argv[4]) : 10;
  const int l0 = argc > 3 ? std::atoi(argv[3]) : 25;
  const auto curves = strong_curves(argv[1], h, l0);
  const auto pairs_of = [&](const Polyline& a, const Polyline& b) {
    return 2.0 * (a.size() - l0 + 1) * (b.size() - l0 + 1);
  };
  double samples = 0, total = 0, done = 0, affinity = 0;
  long matches = 0;
  std::vector<std::pair<int, int>> order;
  for (size_t i = 0; i < curves.size(); ++i) {
    samples += curves[i].size();
    for (size_t j = i + 1; j < curves.size(); ++j) order.push_back({i, j}), total += pairs_of(curves[i], curves[j]);
  }
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  Comparison distance;
  const auto begin = std::chrono::steady_clock::now();
  double seconds = 0;
  for (const auto& [i, j] : order) {
    const Polyline &a = curves[i], &b = curves[j];
    const int na = a.size(), nb = b.size();
    for (const int sense : {1, -1}) {
      for (int x = 0; x + l0 <= na; ++x) {
        for (int y = sense > 0 ? 0 : l0 - 1; sense > 0 ? y + l0 <= nb : y < nb; ++y) {
          double d = distance(&a[x], &b[y], sense, l0);
          if (d >= h) continue;
          int length = l0;
          const int room = std::min(na - x, sense > 0 ? nb - y : y + 1);
          while (length + kDeltaL <= room) {
            const double further = distance(&a[x], &b[y], sense, length + kDeltaL);
            if (further >= 2 * h) break;
            length += kDeltaL, d = further;
          }
          ++matches;
          affinity += length * h * std::exp(-d / h);
        }
      }
    }
    done += pairs_of(a, b);
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (seconds > budget) break;
  }
  const double each = done > 0 ? seconds / done : 0;
  std::printf(
      "{\"strong_curves\": %zu, \"strong_samples\": %.0f, \"point_pairs\": %.0f, \"measured_pairs\": %.0f, "
      "\"match_share\": %.4f, \"affinity\": %.6g, \"ns_per_pair\": %.1f, \"projected_seconds\": %.2f}\n",
      curves.size(), samples, total, done, done > 0 ? matches / done : 0, affinity, each * 1e9, each * total);
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 2;
}
