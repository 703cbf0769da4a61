// Hand tracking: the residuals, and their Jacobian column by column; a finger's angle moves its own bones alone.
#include <array>
#include <cmath>
#include <vector>

using Matrix = std::array<double, 16>;      // 4 x 4, row by row
using Rotation = std::array<double, 9>;
using Vertices = std::vector<double>;

struct Hand {
  int bones, vertices, count, mirrored;
  const long* parents;
  const double *relatives, *inverses, *positions, *weights;
  const long *triangles, *correspondences;
  const double *points, *theta, *us;        // us is null where points correspond to vertices
};

static Matrix product(const double* a, const double* b) {
  Matrix out{};
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 4; k++)
      for (int j = 0; j < 4; j++) out[4 * i + j] += a[4 * i + k] * b[4 * k + j];
  return out;
}

// The rotation about x, then z; for `by` 1 or 2 its derivative for one of these.
static Matrix euler(double x, double z, int by) {
  const double cx = by == 1 ? -std::sin(x) : std::cos(x), sx = by == 1 ? std::cos(x) : std::sin(x);
  const double cz = by == 2 ? -std::sin(z) : std::cos(z), sz = by == 2 ? std::cos(z) : std::sin(z);
  if (by == 1) return {0, -sz * cx, sz * sx, 0, 0, cz * cx, -cz * sx, 0, 0, sx, cx, 0, 0, 0, 0, 0};
  if (by == 2) return {cz, -sz * cx, sz * sx, 0, sz, cz * cx, -cz * sx, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  return {cz, -sz * cx, sz * sx, 0, sz, cz * cx, -cz * sx, 0, 0, sx, cx, 0, 0, 0, 0, 1};
}

static Rotation times(const Rotation& a, const Rotation& b) {
  Rotation out{};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      for (int j = 0; j < 3; j++) out[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return out;
}

static Rotation skew(double x, double y, double z) { return {0, -z, y, z, 0, -x, -y, x, 0}; }

// I + s K + (1 - c) K^2, or its derivative along axis `by`.
static Rotation global_rotation(const double* w, int by) {
  const double angle = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  Rotation out{};
  if (angle < 0.0001) {
    if (by < 0) out[0] = out[4] = out[8] = 1.0;
    return out;
  }
  const double v[3] = {w[0] / angle, w[1] / angle, w[2] / angle}, s = std::sin(angle), c = std::cos(angle);
  const Rotation k = skew(v[0], v[1], v[2]), kk = times(k, k);
  if (by < 0) {
    for (int i = 0; i < 9; i++) out[i] = (i % 4 == 0) + s * k[i] + (1.0 - c) * kk[i];
    return out;
  }
  double d[3];
  for (int i = 0; i < 3; i++) d[i] = ((i == by) - v[i] * v[by]) / angle;
  const Rotation dk = skew(d[0], d[1], d[2]), left = times(dk, k), right = times(k, dk);
  for (int i = 0; i < 9; i++)
    out[i] = v[by] * (c * k[i] + s * kk[i]) + s * dk[i] + (1.0 - c) * (left[i] + right[i]);
  return out;
}

static void angles(const double* theta, int bone, double& x, double& z) {
  const int finger = (bone - 1) / 4, joint = (bone - 1) % 4;
  x = z = 0.0;
  if (bone == 0 || finger > 4 || joint == 0) return;
  x = theta[6 + 4 * finger + (joint == 1 ? 0 : joint)];
  if (joint == 1) z = theta[7 + 4 * finger];
}

static void skin(const Hand& hand, int bone, const Matrix& absolute, Vertices& out) {
  const Matrix moved = product(absolute.data(), hand.inverses + 16 * bone);
  for (int v = 0; v < hand.vertices; v++) {
    const double w = hand.weights[v * hand.bones + bone], *x = hand.positions + 4 * v;
    for (int i = 0; i < 3; i++)
      out[3 * v + i] += w * (moved[4 * i] * x[0] + moved[4 * i + 1] * x[1] + moved[4 * i + 2] * x[2] +
                             moved[4 * i + 3] * x[3]);
  }
}

static void turn(const Hand& hand, const Rotation& r, const Vertices& in, Vertices& out) {
  const double sign = hand.mirrored ? -1.0 : 1.0;
  for (int v = 0; v < hand.vertices; v++)
    for (int i = 0; i < 3; i++)
      out[3 * v + i] = r[3 * i] * sign * in[3 * v] + r[3 * i + 1] * in[3 * v + 1] + r[3 * i + 2] * in[3 * v + 2];
}

// Where the corresponding points lie for given vertices; `factor` times that goes to out[stride * row].
static void correspond(const Hand& hand, const Vertices& at, double factor, double* out, int stride) {
  for (int n = 0; n < hand.count; n++)
    for (int i = 0; i < 3; i++) {
      double found = at[3 * hand.correspondences[n] * (hand.us == nullptr) + i];
      if (hand.us) {
        const long* t = hand.triangles + 3 * hand.correspondences[n];
        const double u = hand.us[2 * n], v = hand.us[2 * n + 1];
        found = u * at[3 * t[0] + i] + v * at[3 * t[1] + i] + (1.0 - u - v) * at[3 * t[2] + i];
      }
      out[(3 * n + i) * stride] = factor * found;
    }
}

static void pose(const Hand& hand, std::vector<Matrix>& absolute, Vertices& skinned, Vertices& posed) {
  for (int k = 0; k < hand.bones; k++) {
    double x, z;
    angles(hand.theta, k, x, z);
    const Matrix relative = product(hand.relatives + 16 * k, euler(x, z, 0).data());
    absolute[k] = hand.parents[k] < 0 ? relative : product(absolute[hand.parents[k]].data(), relative.data());
    skin(hand, k, absolute[k], skinned);
  }
  turn(hand, global_rotation(hand.theta, -1), skinned, posed);
  for (int v = 0; v < 3 * hand.vertices; v++) posed[v] += hand.theta[3 + v % 3];
}

extern "C" void ht_objective(const Hand* hand, double* out) {
  std::vector<Matrix> absolute(hand->bones);
  Vertices skinned(3 * hand->vertices), posed(3 * hand->vertices);
  pose(*hand, absolute, skinned, posed);
  correspond(*hand, posed, -1.0, out, 1);
  for (int k = 0; k < 3 * hand->count; k++) out[k] += hand->points[k];
}

// The vertices' derivative for an angle of a finger: `by` 1 or 2 of euler at its bone, passed on to the bones behind.
static void moved_by(const Hand& hand, int bone, int by, const std::vector<Matrix>& absolute, Vertices& out) {
  std::vector<Matrix> moving(hand.bones);
  std::vector<char> moves(hand.bones);
  for (int k = bone; k < hand.bones; k++) {
    const long parent = hand.parents[k];
    if (k != bone && (parent < 0 || !moves[parent])) continue;
    double x, z;
    angles(hand.theta, k, x, z);
    const Matrix relative = product(hand.relatives + 16 * k, euler(x, z, k == bone ? by : 0).data());
    moving[k] = k != bone ? product(moving[parent].data(), relative.data())
                : parent < 0 ? relative : product(absolute[parent].data(), relative.data());
    moves[k] = 1;
    skin(hand, k, moving[k], out);
  }
}

extern "C" void ht_jacobian(const Hand* hand, double* out) {
  const int first = hand->us ? 2 : 0, stride = 26 + first;
  std::vector<Matrix> absolute(hand->bones);
  Vertices skinned(3 * hand->vertices), posed(3 * hand->vertices), moved(3 * hand->vertices);
  pose(*hand, absolute, skinned, posed);
  for (int n = 0; hand->us && n < hand->count; n++) {
    const long* t = hand->triangles + 3 * hand->correspondences[n];
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 2; k++) out[(3 * n + i) * stride + k] = posed[3 * t[2] + i] - posed[3 * t[k] + i];
  }
  for (int k = 0; k < 3; k++) {
    turn(*hand, global_rotation(hand->theta, k), skinned, moved);
    correspond(*hand, moved, -1.0, out + first + k, stride);
    for (int row = 0; row < 3 * hand->count; row++) out[row * stride + first + 3 + k] = row % 3 == k ? -1.0 : 0.0;
  }
  const Rotation rotation = global_rotation(hand->theta, -1);
  for (int k = 6; k < 26; k++) {
    const int finger = (k - 6) / 4, part = (k - 6) % 4;
    Vertices along(3 * hand->vertices);
    moved_by(*hand, 2 + 4 * finger + (part > 1 ? part - 1 : 0), part == 1 ? 2 : 1, absolute, along);
    turn(*hand, rotation, along, moved);
    correspond(*hand, moved, -1.0, out + first + k, stride);
  }
}
