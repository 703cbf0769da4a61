"""Hand tracking: how far a skinned hand, posed by 26 parameters, is from measured points."""
import numpy as np


def multiply(a, b, out):
    """Writes the product of two 4 x 4 matrices."""
    for i in range(4):
        for j in range(4):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j] + a[i, 3] * b[3, j]


def euler(x, z, out):
    """Writes the rotation about the axis x, then z, into an identity of 4 x 4."""
    cx, sx, cz, sz = np.cos(x), np.sin(x), np.cos(z), np.sin(z)
    out[0, 0], out[0, 1], out[0, 2] = cz, -sz * cx, sz * sx
    out[1, 0], out[1, 1], out[1, 2] = sz, cz * cx, -cz * sx
    out[2, 1], out[2, 2] = sx, cx


def angle_axis(w, out):
    """Writes the rotation about w by an angle of |w|."""
    angle = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    if angle < 0.0001:
        out[:] = np.eye(3)
    else:
        x, y, z = w[0] / angle, w[1] / angle, w[2] / angle
        s, c = np.sin(angle), np.cos(angle)
        t = 1.0 - c
        out[0, 0], out[0, 1], out[0, 2] = x * x + (1.0 - x * x) * c, x * y * t - z * s, x * z * t + y * s
        out[1, 0], out[1, 1], out[1, 2] = x * y * t + z * s, y * y + (1.0 - y * y) * c, y * z * t - x * s
        out[2, 0], out[2, 1], out[2, 2] = x * z * t - y * s, z * y * t + x * s, z * z + (1.0 - z * z) * c


def bend(theta, bone, out):
    """Writes the rotation of a bone: of the four bones of a finger the first is fixed, the second has two angles."""
    finger, joint = (bone - 1) // 4, (bone - 1) % 4
    if bone > 0 and finger < 5 and joint == 1:
        euler(theta[6 + 4 * finger], theta[7 + 4 * finger], out)
    elif bone > 0 and finger < 5 and joint > 1:
        euler(theta[6 + 4 * finger + joint], 0.0, out)


def vertices(theta, parents, relatives, inverses, positions, weights, mirrored, out):
    """Writes the vertices (v, 3) of the posed hand: positions (v, 4) and weights (v, bones)."""
    absolute = np.zeros((parents.size, 4, 4))
    turn, relative, moved, rotation = np.empty((4, 4)), np.empty((4, 4)), np.empty((4, 4)), np.empty((3, 3))
    posed = np.zeros(out.shape)
    for k in range(parents.size):
        turn[:] = np.eye(4)
        bend(theta, k, turn)
        multiply(relatives[k], turn, relative)
        if parents[k] == -1:
            absolute[k] = relative
        else:
            multiply(absolute[parents[k]].copy(), relative, absolute[k])
        multiply(absolute[k], inverses[k], moved)
        for v in range(out.shape[0]):
            for i in range(3):
                posed[v, i] += weights[v, k] * (moved[i, 0] * positions[v, 0] + moved[i, 1] * positions[v, 1]
                                                + moved[i, 2] * positions[v, 2] + moved[i, 3] * positions[v, 3])
    angle_axis(theta[:3], rotation)
    sign = -1.0 if mirrored else 1.0
    for v in range(out.shape[0]):
        for i in range(3):
            out[v, i] = theta[3 + i] + (rotation[i, 0] * sign * posed[v, 0] + rotation[i, 1] * posed[v, 1]
                                        + rotation[i, 2] * posed[v, 2])


def simple(theta, parents, relatives, inverses, positions, weights, mirrored, correspondences, points):
    """The residuals (n, 3) where each point corresponds to a vertex."""
    posed = np.empty((positions.shape[0], 3))
    vertices(theta, parents, relatives, inverses, positions, weights, mirrored, posed)
    return points - posed[correspondences]


def complicated(theta, us, parents, relatives, inverses, positions, weights, triangles, mirrored, correspondences,
                points):
    """The residuals (n, 3) where each point corresponds to a place us (n, 2) in a triangle."""
    posed, found = np.empty((positions.shape[0], 3)), np.empty(points.shape)
    vertices(theta, parents, relatives, inverses, positions, weights, mirrored, posed)
    for i in range(correspondences.size):
        a, b, c = triangles[correspondences[i]]
        u, v = us[i]
        for m in range(3):
            found[i, m] = points[i, m] - (u * posed[a, m] + v * posed[b, m] + (1.0 - u - v) * posed[c, m])
    return found
