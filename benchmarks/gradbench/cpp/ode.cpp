// Runge-Kutta's method of order 4, and the gradient of the last element of its result.
#include <algorithm>
#include <vector>

using Vector = std::vector<double>;

static void slopes(int n, const double* x, const double* y, double* out) {
  out[0] = x[0];
  for (int i = 1; i < n; i++) out[i] = x[i] * y[i - 1];
}

// The state after a step; the points at which slopes are taken go to u, four after another.
static void step(int n, const double* x, double h, double* y, double* u, Vector (&k)[4]) {
  const double part[4] = {0.0, 0.5 * h, 0.5 * h, h};
  for (int stage = 0; stage < 4; stage++) {
    double* at = u + stage * n;
    if (stage == 0) std::copy(y, y + n, at);
    else for (int i = 0; i < n; i++) at[i] = y[i] + part[stage] * k[stage - 1][i];
    slopes(n, x, at, k[stage].data());
  }
  for (int i = 0; i < n; i++) y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

extern "C" void ode_primal(int n, const double* x, int s, double* y) {
  Vector k[4] = {Vector(n), Vector(n), Vector(n), Vector(n)}, u(4 * n);
  std::fill(y, y + n, 0.0);
  for (int t = 0; t < s; t++) step(n, x, 2.0 / s, y, u.data(), k);
}

extern "C" void ode_gradient(int n, const double* x, int s, double* x_bar) {
  const double h = 2.0 / s, part[4] = {0.0, 0.5 * h, 0.5 * h, h}, weight[4] = {h / 6.0, h / 3.0, h / 3.0, h / 6.0};
  Vector k[4] = {Vector(n), Vector(n), Vector(n), Vector(n)}, y(n), y_bar(n), k_bar(n), above(n);
  std::vector<Vector> tape(s, Vector(4 * n));
  for (int t = 0; t < s; t++) step(n, x, h, y.data(), tape[t].data(), k);
  std::fill(x_bar, x_bar + n, 0.0);
  y_bar[n - 1] = 1.0;
  for (int t = s - 1; t >= 0; t--) {
    Vector before = y_bar;
    std::fill(above.begin(), above.end(), 0.0);
    for (int stage = 3; stage >= 0; stage--) {
      const double* u = tape[t].data() + stage * n;
      const double next = stage < 3 ? part[stage + 1] : 0.0;
      for (int i = 0; i < n; i++) k_bar[i] = weight[stage] * y_bar[i] + next * above[i];
      x_bar[0] += k_bar[0];
      for (int i = 1; i < n; i++) {
        x_bar[i] += k_bar[i] * u[i - 1];
        above[i - 1] = x[i] * k_bar[i];
      }
      above[n - 1] = 0.0;
      for (int i = 0; i < n; i++) before[i] += above[i];
    }
    y_bar.swap(before);
  }
}
