"""Arrays: how they are made, written in place, shaped and moved."""

ROWS = {
    "arrays of numbers": """
        np.empty(4); z[:] = x; z
        np.ndarray(4); z[:] = x; z
        np.zeros(4) + x
        np.ones((4, 4)) * x
        np.full(4, x[0])
        np.empty_like(x); z[:] = x; z
        np.zeros_like(m) + x
        np.ones_like(x) * x
        np.full_like(x, x[1])
        np.array([x[0], y[1] * x[2]])
        np.array([[x[0], y[1]], [1.0, x[3]]])
        np.array(x)
        np.copy(x) * x.copy()
        np.asarray(x) * x
        x.astype(np.float32).astype(np.float64)
        x.sum().astype(float) * sum(x.tolist())
        m @ np.eye(4)
        m @ np.identity(4) @ np.eye(4, k=1)
        np.tri(4) * x
        np.arange(4) * x
        np.arange(0.0, 2.0, 0.5) * x
        np.linspace(x[0], y[1], 4) * x
        np.linspace(0.0, 1.0, 4, endpoint=False) * x
        np.logspace(x[0], y[1], 4)
        np.geomspace(x[0], y[1], 4)
        np.hanning(4) * x
        np.hamming(4) * x
        np.blackman(4) * x
        np.bartlett(4) * x
        np.diag(x) @ x
        np.diag(m)
        np.diag(m, 1)
        np.diagflat(x, 1)
        np.vander(x, 3)
        np.vander(x)
    """,
    "in place": """
        np.zeros(4); np.sin(x, out=z); z
        np.zeros(4); np.multiply(x, y, out=z, where=x > 0.5); z
        np.zeros(4); np.dot(m, x, out=z); z
        np.zeros((4, 4)); np.matmul(m, m, out=z); z
        np.zeros(4); np.sum(m, axis=0, out=z); z
        np.zeros(4); np.copyto(z, x); z
        np.zeros(4); np.copyto(z, x, where=x > 0.5); z
        np.zeros(4); z.fill(x[0]); z
        x * y; z.sort(); z * x
        m * 1.0; np.fill_diagonal(z, x[0]); z
        x * y; np.put(z, [0, 2], x[1]); z
        x * y; z.put([0, 2], x[1]); z
        m * 1.0; z.flat[5] = x[1]; z
        x * y; np.putmask(z, x > 0.5, x[1]); z
        x * y; np.place(z, x > 0.5, [x[1]]); z
        x * y; np.add.at(z, p, x); z
        x * y; np.subtract.at(z, p, x); z
        x * y; np.multiply.at(z, p, x); z
        x * y; np.divide.at(z, p, x); z
        x * y; np.maximum.at(z, p, x); z
        x * y; np.minimum.at(z, p, x); z
    """,
    "of ufuncs": """
        np.add.reduce(m) * np.add.accumulate(x)
        np.multiply.reduce(m, axis=1) * np.multiply.accumulate(x)
        np.maximum.reduce(m) * np.maximum.accumulate(x)
        np.minimum.reduce(m) * np.minimum.accumulate(x)
        np.add.outer(x, y) * np.multiply.outer(x, y)
        np.maximum.outer(x, y) * np.minimum.outer(x, y)
        np.subtract.outer(x, y) * np.divide.outer(x, y)
        np.power.outer(x, y) * np.hypot.outer(x, y)
        np.logaddexp.outer(x, y) * np.arctan2.outer(x, y)
        np.logaddexp.reduce(x) * np.logaddexp.accumulate(x)
        np.hypot.reduce(x)
        np.add.reduceat(x, [0, 2])
    """,
    "shape": """
        np.broadcast_arrays(m, x)[1] * np.rollaxis(m, 1)
        np.lib.stride_tricks.sliding_window_view(x, 2)
        np.lib.stride_tricks.sliding_window_view(m, (2, 3))
        np.lib.stride_tricks.sliding_window_view(m, 3, axis=1)
        np.reshape(m, (2, 8)) * m.reshape(2, -1)
        np.ravel(m) * m.ravel() * m.flatten()
        np.reshape(m, (2, 8), order="F") * m.reshape(2, -1, order="C")
        np.ravel(m, order="F") * m.ravel("F") * m.flatten("F")
        np.atleast_3d(x) * y
        np.transpose(m) * m.T * m.transpose()
        np.transpose(s, (1, 0, 2)) * np.swapaxes(s, 0, 1)
        np.moveaxis(s, 0, 2)
        np.expand_dims(x, 1) * np.expand_dims(y, 0)
        np.squeeze(x.reshape(4, 1), axis=1)
        np.atleast_1d(x) * np.atleast_2d(y)
        np.broadcast_to(x, (3, 4))
    """,
    "moving elements": """
        np.roll(x, 1) * y
        np.roll(m, 1, axis=0) * m
        np.flip(x) * y
        np.flip(m, axis=1) * m
        np.fliplr(m) * np.flipud(m) * m
        np.rot90(m) * m
        np.rot90(s, axes=(1, 2)) * s
        np.tile(x, 3)
        np.tile(m, (2, 1))
        np.repeat(x, 2)
        np.repeat(m, 2, axis=1)
        np.repeat(x, [1, 0, 2, 3])
        np.delete(x, 1)
        np.delete(x, [0, 2])
        np.delete(x, x > 0.5)
        np.insert(x, 1, y[0])
        np.pad(x, 2)
        np.pad(m, ((1, 0), (2, 1)), mode="edge")
        np.pad(x, 2, mode="wrap")
        np.pad(x, 2, mode="reflect")
        np.pad(x, 2, mode="symmetric")
        np.pad(x, 2, mode="linear_ramp")
        np.pad(x, 2, mode="mean")
        np.pad(x, 2, mode="maximum")
        np.pad(x, 2, mode="minimum")
        np.concatenate((x, y))
        np.concatenate((m, m), axis=1)
        np.stack((x, y)) * np.stack((y, x))
        np.stack((x, y), axis=1)
        np.hstack((x, y))
        np.vstack((x, y)) * np.vstack((y, y))
        np.dstack((x, y))
        np.column_stack((x, y))
        np.block([[m, m], [m, m]])
        np.append(x, y)
        np.r_[x, y]
        np.c_[x, y]
        0.0; b, c = np.split(x, 2); b * c
        0.0; b, c = np.array_split(x, 2); b * c
        0.0; b, c = np.hsplit(m, 2); b * c
        0.0; b, c = np.vsplit(m, 2); b * c
    """,
}
