// The determinant by recursive expansion by minors, and its gradient in the same recursion.
#include <vector>

// The minor of the rows from `row` on and the columns that are left, in a list linked by `next` from index n on.
static double minor_of(int n, int row, const double* a, int* next) {
  if (row == n - 1) return a[row * n + next[n]];
  double total = 0.0, sign = 1.0;
  for (int before = n, column = next[n]; column < n; before = column, column = next[column], sign = -sign) {
    next[before] = next[column];
    total += sign * a[row * n + column] * minor_of(n, row + 1, a, next);
    next[before] = column;
  }
  return total;
}

static double minor_gradient(int n, int row, const double* a, int* next, double seed, double* a_bar) {
  if (row == n - 1) {
    a_bar[row * n + next[n]] += seed;
    return a[row * n + next[n]];
  }
  double total = 0.0, sign = 1.0;
  for (int before = n, column = next[n]; column < n; before = column, column = next[column], sign = -sign) {
    next[before] = next[column];
    const double entry = sign * a[row * n + column];
    const double below = minor_gradient(n, row + 1, a, next, seed * entry, a_bar);
    a_bar[row * n + column] += seed * sign * below;
    total += entry * below;
    next[before] = column;
  }
  return total;
}

static std::vector<int> all_columns(int n) {
  std::vector<int> next(n + 1);
  for (int j = 0; j < n; j++) next[j] = j + 1;
  next[n] = 0;
  return next;
}

extern "C" double det_primal(int n, const double* a) {
  auto next = all_columns(n);
  return minor_of(n, 0, a, next.data());
}

extern "C" void det_gradient(int n, const double* a, double* a_bar) {
  auto next = all_columns(n);
  for (int k = 0; k < n * n; k++) a_bar[k] = 0.0;
  minor_gradient(n, 0, a, next.data(), 1.0, a_bar);
}
