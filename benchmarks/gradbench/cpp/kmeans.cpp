// k-means: the cost, and the direction of Newton's method, which leads to the centroids' means.
#include <limits>
#include <vector>

static int nearest(int k, int d, const double* point, const double* centroids, double& smallest) {
  int found = 0;
  smallest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < k; j++) {
    double distance = 0.0;
    for (int m = 0; m < d; m++) {
      const double difference = point[m] - centroids[j * d + m];
      distance += difference * difference;
    }
    if (distance < smallest) {
      smallest = distance;
      found = j;
    }
  }
  return found;
}

extern "C" double kmeans_cost(int n, int k, int d, const double* points, const double* centroids) {
  double total = 0.0, smallest;
  for (int i = 0; i < n; i++) {
    nearest(k, d, points + i * d, centroids, smallest);
    total += smallest;
  }
  return total;
}

extern "C" void kmeans_dir(int n, int k, int d, const double* points, const double* centroids, double* out) {
  std::vector<double> gradient(k * d), hessian(k);
  double smallest;
  for (int i = 0; i < n; i++) {
    const int j = nearest(k, d, points + i * d, centroids, smallest);
    hessian[j] += 2.0;
    for (int m = 0; m < d; m++) gradient[j * d + m] += 2.0 * (centroids[j * d + m] - points[i * d + m]);
  }
  for (int j = 0; j < k; j++)
    for (int m = 0; m < d; m++) out[j * d + m] = gradient[j * d + m] / hessian[j];
}
