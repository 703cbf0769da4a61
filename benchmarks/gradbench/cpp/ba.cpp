// Bundle adjustment: the residuals, and their Jacobian in compressed rows.
#include <algorithm>
#include <cmath>
#include <vector>

static void cross(const double* a, const double* b, double* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// The rotated point; where `by_r` is given, its derivatives for the rotation and for the point, column by column.
static void rotate(const double* r, const double* x, double* out, double (*by_r)[3], double (*by_x)[3]) {
  const double angle = std::sqrt(dot(r, r)), c = std::cos(angle), s = std::sin(angle);
  double v[3] = {0, 0, 0}, vx[3];
  if (angle == 0.0) {
    cross(r, x, vx);
    for (int i = 0; i < 3; i++) out[i] = x[i] + vx[i];
  } else {
    for (int i = 0; i < 3; i++) v[i] = r[i] / angle;
    cross(v, x, vx);
    const double along = dot(v, x);
    for (int i = 0; i < 3; i++) out[i] = x[i] * c + vx[i] * s + v[i] * along * (1.0 - c);
  }
  if (!by_r) return;
  for (int k = 0; k < 3; k++) {
    double e[3] = {0, 0, 0}, turned[3], dv[3], dvx[3];
    e[k] = 1.0;
    cross(angle == 0.0 ? r : v, e, turned);
    for (int i = 0; i < 3; i++)
      by_x[k][i] = angle == 0.0 ? e[i] + turned[i] : e[i] * c + turned[i] * s + v[i] * v[k] * (1.0 - c);
    if (angle == 0.0) {
      cross(e, x, by_r[k]);
      continue;
    }
    const double along = dot(v, x);
    for (int i = 0; i < 3; i++) dv[i] = (e[i] - v[i] * v[k]) / angle;
    cross(dv, x, dvx);
    const double d_along = dot(dv, x);
    for (int i = 0; i < 3; i++)
      by_r[k][i] = v[k] * (-x[i] * s + vx[i] * c + v[i] * along * s) + dvx[i] * s +
                   (dv[i] * along + v[i] * d_along) * (1.0 - c);
  }
}

// Two residuals; where `rows` is given, 15 derivatives of each: camera, point, weight.
static void observe(const double* cam, const double* point, double w, const double* feat, double* out, double* rows) {
  double x[3], seen[3], by_r[3][3], by_x[3][3];
  for (int i = 0; i < 3; i++) x[i] = point[i] - cam[3 + i];
  rotate(cam, x, seen, rows ? by_r : nullptr, by_x);
  const double p[2] = {seen[0] / seen[2], seen[1] / seen[2]}, square = p[0] * p[0] + p[1] * p[1];
  const double distortion = 1.0 + cam[9] * square + cam[10] * square * square, f = cam[6];
  for (int i = 0; i < 2; i++) out[i] = w * (p[i] * distortion * f + cam[7 + i] - feat[i]);
  if (!rows) return;
  const double slope = cam[9] + 2.0 * cam[10] * square;   // of the distortion for the square
  for (int i = 0; i < 2; i++) {
    double by_seen[3], *row = rows + 15 * i;
    for (int j = 0; j < 2; j++)
      by_seen[j] = w * f * ((i == j) * distortion + 2.0 * p[i] * slope * p[j]) / seen[2];
    by_seen[2] = -(by_seen[0] * p[0] + by_seen[1] * p[1]);
    for (int k = 0; k < 3; k++) {
      row[k] = dot(by_seen, by_r[k]);
      row[11 + k] = dot(by_seen, by_x[k]);
      row[3 + k] = -row[11 + k];
    }
    row[6] = w * p[i] * distortion;
    row[7] = i == 0 ? w : 0.0;
    row[8] = i == 1 ? w : 0.0;
    row[9] = w * f * p[i] * square;
    row[10] = row[9] * square;
    row[14] = p[i] * distortion * f + cam[7 + i] - feat[i];
  }
}

extern "C" void ba_objective(int n, int m, int p, const double* cams, const double* points, const double* w,
                             const double* feats, double* out, double* of_weights) {
  for (int i = 0; i < p; i++) {
    observe(cams + 11 * (i % n), points + 3 * (i % m), w[i], feats + 2 * i, out + 2 * i, nullptr);
    of_weights[i] = 1.0 - w[i] * w[i];
  }
}

extern "C" void ba_jacobian(int n, int m, int p, const double* cams, const double* points, const double* w,
                            const double* feats, long* starts, long* columns, double* values) {
  double out[2];
  for (int i = 0; i < p; i++) {
    observe(cams + 11 * (i % n), points + 3 * (i % m), w[i], feats + 2 * i, out, values + 30 * i);
    for (int row = 0; row < 2; row++) {
      starts[2 * i + row] = 15L * (2 * i + row);
      for (int k = 0; k < 11; k++) *columns++ = 11 * (i % n) + k;
      for (int k = 0; k < 3; k++) *columns++ = 11 * n + 3 * (i % m) + k;
      *columns++ = 11 * n + 3 * m + i;
    }
  }
  for (int i = 0; i < p; i++) {
    starts[2 * p + i] = 30L * p + i;
    *columns++ = 11 * n + 3 * m + i;
    values[30 * p + i] = -2.0 * w[i];
  }
  starts[3 * p] = 31L * p;
}
