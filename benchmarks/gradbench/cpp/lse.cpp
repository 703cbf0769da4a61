// The logarithm of a sum of exponentials and its gradient.
#include <algorithm>
#include <cmath>

extern "C" double lse_primal(int n, const double* x) {
  const double largest = *std::max_element(x, x + n);
  double total = 0.0;
  for (int i = 0; i < n; i++) total += std::exp(x[i] - largest);
  return largest + std::log(total);
}

extern "C" void lse_gradient(int n, const double* x, double* x_bar) {
  const double largest = *std::max_element(x, x + n);
  double total = 0.0;
  for (int i = 0; i < n; i++) total += x_bar[i] = std::exp(x[i] - largest);
  for (int i = 0; i < n; i++) x_bar[i] /= total;
}
