// Linear least squares and its gradient.
static double residual(int m, const double* x, double t) {
  double r = (t > 0.0) - (t < 0.0), power = 1.0;
  for (int j = 0; j < m; j++, power *= t) r -= x[j] * power;
  return r;
}

extern "C" double llsq_primal(int m, const double* x, int n) {
  double total = 0.0;
  for (int i = 0; i < n; i++) {
    const double r = residual(m, x, -1.0 + i * 2.0 / (n - 1));
    total += r * r;
  }
  return 0.5 * total;
}

extern "C" void llsq_gradient(int m, const double* x, int n, double* x_bar) {
  for (int j = 0; j < m; j++) x_bar[j] = 0.0;
  for (int i = 0; i < n; i++) {
    const double t = -1.0 + i * 2.0 / (n - 1), r = residual(m, x, t);
    double power = r;
    for (int j = 0; j < m; j++, power *= t) x_bar[j] -= power;
  }
}
