"""Hand tracking: how far a skinned hand, posed by 26 parameters, is from measured points."""
import numpy as np


def euler(x, z):
    """The rotation about the axis x, then z, as a 4 x 4 matrix."""
    cx, sx, cz, sz = np.cos(x), np.sin(x), np.cos(z), np.sin(z)
    return np.array([[cz, -sz * cx, sz * sx, 0.0], [sz, cz * cx, -cz * sx, 0.0], [0.0, sx, cx, 0.0],
                     [0.0, 0.0, 0.0, 1.0]])


def angle_axis(w):
    """The rotation about w by an angle of |w|."""
    angle = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if angle < 0.0001:
        return np.eye(3)
    x, y, z = w[0] / angle, w[1] / angle, w[2] / angle
    s, c = np.sin(angle), np.cos(angle)
    return np.array([[x * x + (1.0 - x * x) * c, x * y * (1.0 - c) - z * s, x * z * (1.0 - c) + y * s],
                     [x * y * (1.0 - c) + z * s, y * y + (1.0 - y * y) * c, y * z * (1.0 - c) - x * s],
                     [x * z * (1.0 - c) - y * s, z * y * (1.0 - c) + x * s, z * z + (1.0 - z * z) * c]])


def angles(theta, bone):
    """The angles about x and z of a bone: four bones a finger, the first of which is fixed."""
    finger, joint = (bone - 1) // 4, (bone - 1) % 4
    if bone == 0 or finger > 4 or joint == 0:
        return 0.0, 0.0
    start = 6 + 4 * finger
    if joint == 1:
        return theta[start], theta[start + 1]
    return theta[start + joint], 0.0


def vertices(theta, parents, relatives, inverses, positions, weights, mirrored):
    """The vertices (v, 3) of the posed hand: positions (v, 4) and weights (v, bones)."""
    bones = parents.size
    absolute = np.zeros((bones, 4, 4))
    posed = np.zeros((positions.shape[0], 3))
    for k in range(bones):
        x, z = angles(theta, k)
        turned = relatives[k] @ euler(x, z)
        absolute[k] = turned if parents[k] == -1 else absolute[parents[k]] @ turned
        moved = positions @ (absolute[k] @ inverses[k]).T
        posed += weights[:, k:k + 1] * moved[:, :3]
    if mirrored:
        posed[:, 0] *= -1.0
    return posed @ angle_axis(theta[:3]).T + theta[3:6]


def simple(theta, parents, relatives, inverses, positions, weights, mirrored, correspondences, points):
    """The residuals (n, 3) where each point corresponds to a vertex."""
    posed = vertices(theta, parents, relatives, inverses, positions, weights, mirrored)
    return points - posed[correspondences]


def complicated(theta, us, parents, relatives, inverses, positions, weights, triangles, mirrored, correspondences,
                points):
    """The residuals (n, 3) where each point corresponds to a place us (n, 2) in a triangle."""
    posed = vertices(theta, parents, relatives, inverses, positions, weights, mirrored)
    found = np.empty(points.shape)
    for i in range(correspondences.size):
        a, b, c = triangles[correspondences[i]]
        u, v = us[i]
        found[i] = u * posed[a] + v * posed[b] + (1.0 - u - v) * posed[c]
    return points - found
