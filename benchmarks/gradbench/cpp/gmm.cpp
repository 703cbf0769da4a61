// The log posterior of a mixture of Gaussians and its gradient; l holds what lies below the diagonal by columns.
#include <algorithm>
#include <cmath>
#include <vector>

using Vector = std::vector<double>;

struct Mixture {
  int d, k, n;
  const double *alpha, *mu, *q, *l, *x;
  double gamma;
  int m;
  int below() const { return d * (d - 1) / 2; }
};

static double logsumexp(int n, const double* v) {
  const double largest = *std::max_element(v, v + n);
  double total = 0.0;
  for (int i = 0; i < n; i++) total += std::exp(v[i] - largest);
  return largest + std::log(total);
}

// y = Q (x - mu) for one point and one component
static void whitened(const Mixture& p, int c, const double* x, const double* diagonal, double* centred, double* y) {
  const double *mu = p.mu + c * p.d, *l = p.l + c * p.below();
  for (int i = 0; i < p.d; i++) {
    centred[i] = x[i] - mu[i];
    y[i] = diagonal[i] * centred[i];
  }
  for (int j = 0; j < p.d; j++)
    for (int i = j + 1; i < p.d; i++) y[i] += *l++ * centred[j];
}

static double squared(int n, const double* v) {
  double total = 0.0;
  for (int i = 0; i < n; i++) total += v[i] * v[i];
  return total;
}

// The value; where the gradients' arrays are given, these too.
static double posterior(const Mixture& p, double* alpha_bar, double* mu_bar, double* q_bar, double* l_bar) {
  Vector diagonal(p.d * p.k), sums(p.k), centred(p.d * p.k), y(p.d * p.k), terms(p.k);
  for (int i = 0; i < p.d * p.k; i++) {
    diagonal[i] = std::exp(p.q[i]);
    sums[i / p.d] += p.q[i];
  }
  const double lse_alpha = logsumexp(p.k, p.alpha);
  double total = -p.n * (0.5 * p.d * std::log(2.0 * M_PI) + lse_alpha);
  for (int i = 0; i < p.n; i++) {
    for (int c = 0; c < p.k; c++) {
      whitened(p, c, p.x + i * p.d, &diagonal[c * p.d], &centred[c * p.d], &y[c * p.d]);
      terms[c] = p.alpha[c] + sums[c] - 0.5 * squared(p.d, &y[c * p.d]);
    }
    const double lse = logsumexp(p.k, terms.data());
    total += lse;
    if (!alpha_bar) continue;
    for (int c = 0; c < p.k; c++) {
      const double w = std::exp(terms[c] - lse), *x = &centred[c * p.d], *l = p.l + c * p.below();
      double *yc = &y[c * p.d], *mc = mu_bar + c * p.d, *qc = q_bar + c * p.d, *lc = l_bar + c * p.below();
      alpha_bar[c] += w;
      for (int j = 0; j < p.d; j++) {
        yc[j] *= -w;
        qc[j] += w + yc[j] * diagonal[c * p.d + j] * x[j];
      }
      for (int j = 0; j < p.d; j++) {
        double along = diagonal[c * p.d + j] * yc[j];
        for (int r = j + 1; r < p.d; r++, l++, lc++) {
          *lc += yc[r] * x[j];
          along += *l * yc[r];
        }
        mc[j] -= along;
      }
    }
  }
  const int freedom = p.d + p.m + 1;
  double log_gamma = 0.25 * p.d * (p.d - 1) * std::log(M_PI);
  for (int j = 0; j < p.d; j++) log_gamma += std::lgamma(0.5 * (freedom - j));
  total += p.k * (freedom * p.d * (std::log(p.gamma) - 0.5 * std::log(2.0)) - log_gamma);
  const double square = p.gamma * p.gamma;
  for (int c = 0; c < p.k; c++) total += p.m * sums[c];
  total -= 0.5 * square * (squared(p.d * p.k, diagonal.data()) + squared(p.below() * p.k, p.l));
  if (alpha_bar) {
    for (int c = 0; c < p.k; c++) alpha_bar[c] -= p.n * std::exp(p.alpha[c] - lse_alpha);
    for (int i = 0; i < p.d * p.k; i++) q_bar[i] += p.m - square * diagonal[i] * diagonal[i];
    for (int i = 0; i < p.below() * p.k; i++) l_bar[i] -= square * p.l[i];
  }
  return total;
}

extern "C" double gmm_objective(int d, int k, int n, const double* alpha, const double* mu, const double* q,
                                const double* l, const double* x, double gamma, int m) {
  return posterior({d, k, n, alpha, mu, q, l, x, gamma, m}, nullptr, nullptr, nullptr, nullptr);
}

extern "C" void gmm_jacobian(int d, int k, int n, const double* alpha, const double* mu, const double* q,
                             const double* l, const double* x, double gamma, int m, double* out) {
  const int sizes[4] = {k, d * k, d * k, k * d * (d - 1) / 2};
  std::fill(out, out + sizes[0] + sizes[1] + sizes[2] + sizes[3], 0.0);
  posterior({d, k, n, alpha, mu, q, l, x, gamma, m}, out, out + sizes[0], out + sizes[0] + sizes[1],
            out + sizes[0] + sizes[1] + sizes[2]);
}
