"""k-means: the sum of squared distances to the nearest centroid."""


def squared(points, i, centroids, j):
    """The squared distance of a point to a centroid."""
    total = 0.0
    for m in range(points.shape[1]):
        total += (points[i, m] - centroids[j, m]) ** 2
    return total


def cost(points, centroids):
    """The sum over all points of the squared distance to the nearest centroid."""
    total = 0.0
    for i in range(points.shape[0]):
        nearest, smallest = 0, squared(points, i, centroids, 0)
        for j in range(1, centroids.shape[0]):
            distance = squared(points, i, centroids, j)
            if distance < smallest:
                nearest, smallest = j, distance
        total += squared(points, i, centroids, nearest)
    return total
