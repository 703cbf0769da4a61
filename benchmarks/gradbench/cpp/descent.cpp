// The nested evals: descent along a tangent of a path, and along the gradient of a maximum.
#include <cmath>

// The gradient descent that the evals prescribe: the rate halves where the value would grow, doubles after ten steps.
template <int N, typename Value, typename Gradient>
static void lowest(Value value, Gradient gradient, double* x) {
  double rate = 1e-5, found = value(x), slope[N], next[N];
  int steps = 0;
  gradient(x, slope);
  while (true) {
    double square = 0.0, moved = 0.0;
    for (int i = 0; i < N; i++) square += slope[i] * slope[i];
    if (std::sqrt(square) <= 1e-5) return;
    if (steps == 10) {
      rate *= 2.0, steps = 0;
      continue;
    }
    for (int i = 0; i < N; i++) {
      next[i] = x[i] - rate * slope[i];
      moved += (next[i] - x[i]) * (next[i] - x[i]);
    }
    if (std::sqrt(moved) <= 1e-5) return;
    const double there = value(next);
    if (there < found) {
      for (int i = 0; i < N; i++) x[i] = next[i];
      found = there, steps++;
      gradient(x, slope);
    } else {
      rate /= 2.0, steps = 0;
    }
  }
}

// The square of the place where the particle meets the axis, and its derivative for w, carried along the path.
static double miss(double w, double* derivative) {
  double x[2] = {0.0, 8.0}, v[2] = {0.75, 0.0}, dx[2] = {0.0, 0.0}, dv[2] = {0.0, 0.0};
  while (x[1] + 0.1 * v[1] > 0.0) {
    double force[2] = {0.0, 0.0}, d_force[2] = {0.0, 0.0};
    for (int charge = 0; charge < 2; charge++) {
      const double r[2] = {x[0] - 10.0, x[1] - (charge ? 0.0 : 10.0 - w)};
      const double dr[2] = {dx[0], dx[1] + (charge ? 0.0 : 1.0)};
      const double square = r[0] * r[0] + r[1] * r[1], cube = 1.0 / (square * std::sqrt(square));
      const double d_cube = -3.0 * cube * (r[0] * dr[0] + r[1] * dr[1]) / square;
      for (int i = 0; i < 2; i++) {
        force[i] += r[i] * cube;
        d_force[i] += dr[i] * cube + r[i] * d_cube;
      }
    }
    for (int i = 0; i < 2; i++) {
      x[i] += 0.1 * v[i], dx[i] += 0.1 * dv[i];
      v[i] += 0.1 * force[i], dv[i] += 0.1 * d_force[i];
    }
  }
  const double t = -x[1] / v[1], dt = -(dx[1] + t * dv[1]) / v[1], end = x[0] + t * v[0];
  *derivative = 2.0 * end * (dx[0] + t * dv[0] + dt * v[0]);
  return end * end;
}

extern "C" double particle_control(double w) {
  double ignored;
  lowest<1>([&](const double* x) { return miss(*x, &ignored); },
            [](const double* x, double* out) { miss(*x, out); }, &w);
  return w;
}

static double value(const double* p, const double* q) { return p[0] * p[0] + p[1] * p[1] - q[0] * q[0] - q[1] * q[1]; }

static void highest(const double* p, const double* start, double* q) {
  q[0] = start[0], q[1] = start[1];
  lowest<2>([&](const double* x) { return -value(p, x); },
            [](const double* x, double* out) { out[0] = 2.0 * x[0], out[1] = 2.0 * x[1]; }, q);
}

extern "C" void saddle_point(const double* start, double* out) {
  double q[2];
  out[0] = start[0], out[1] = start[1];
  auto along = [&](const double* p, double* slope) {      // where the maximum lies does not depend on p
    highest(p, start, q);
    slope[0] = 2.0 * p[0], slope[1] = 2.0 * p[1];
  };
  auto maximum = [&](const double* p) {
    highest(p, start, q);
    return value(p, q);
  };
  lowest<2>(maximum, along, out);
  highest(out, start, out + 2);
}
