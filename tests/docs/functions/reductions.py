"""What is reduced, found, ordered and summed up."""

ROWS = {
    "reductions": """
        np.sum(m, axis=0) * x.sum()
        np.sum(m, axis=1, keepdims=True) * m
        np.sum(x, where=x > 0.5, initial=2)
        np.sum(s, axis=(0, 2))
        np.mean(m, axis=0) * x.mean()
        np.max(m, axis=0) * x.max()
        np.mean(m, axis=0, where=m > 0.2) * np.max(x, initial=0.6) * np.std(x, where=x > 0.4)
        np.min(m, axis=0) * x.min()
        np.prod(m, axis=0) * x.prod()
        np.prod(x, where=x > 0.5, initial=2)
        np.var(m, axis=0) * x.var()
        np.var(x, ddof=1)
        np.std(m, axis=0) * x.std()
        np.std(x, ddof=1)
        np.ptp(m, axis=0) * np.ptp(x)
        np.nansum(m, axis=0) * np.nansum(x)
        np.nanprod(m, axis=0) * np.nanprod(x)
        np.nanmean(m, axis=0) * np.nanmean(x)
        np.nanmax(m, axis=0) * np.nanmax(x)
        np.nanmin(m, axis=0) * np.nanmin(x)
        np.nanvar(x) * np.nanvar(m, axis=0, ddof=1)
        np.nanstd(x) * np.nanstd(m, axis=0, ddof=1)
        np.cov(m)
        np.corrcoef(m)
        np.average(x, weights=y)
        np.average(m, axis=0)
        np.trace(m) * x
        np.median(x) * np.median(m, axis=0)
        np.percentile(x, 30.0) * np.percentile(m, 30.0, axis=0)
        np.quantile(x, [0.3, 0.6])
        m - np.median(m, axis=1, keepdims=True) * np.percentile(m, 30, axis=0, keepdims=True)
        np.quantile(x, 0.3) * np.quantile(m, 0.3, axis=0)
        x * np.any(x > 0.5) * np.all(x > 0.1) * np.count_nonzero(x > 0.5)
        x * np.any(m > 0.5, axis=0) * np.all(m > 0.1, axis=0)
        np.cumsum(x) * np.cumsum(m, axis=0)
        np.cumprod(x) * np.cumprod(m, axis=1)
        np.nancumsum(x)
    """,
    "places": """
        x[np.argmax(y)] * x[np.argmin(y)]
        x[np.argsort(y)] * x
        x * np.searchsorted(g, x)
        x * np.digitize(x, g)
        x[np.lexsort((y, x))] * y
        x[np.isin(p, np.array([0, 2]))]
        x[np.setdiff1d(p, np.array([0, 2]))]
        x[np.nonzero(x > 0.5)[0]]
        x[np.argwhere(x > 0.5)[:, 0]]
        x[np.flatnonzero(x > 0.5)]
        x[np.where(x > 0.5)]
        x[np.where(x > 0.5)[0]]
        0; i, j = np.unravel_index(k, (4, 4)); m[i, j] * x
        0; i, j = np.indices((4, 4)); m * i * (j + 1)
        0; i, j = np.meshgrid(x, y); i * j
        0; i, j = np.mgrid[0:4, 0:4]; m * i * j
        0; i, j = np.ogrid[0:4, 0:4]; m * i * j
        m[np.triu_indices(4)]
        m[np.tril_indices(4, -1)]
        m[np.diag_indices(4)]
        np.bincount(p, weights=x)
        np.bincount(p, weights=x, minlength=6)
        np.histogram(y, bins=3, range=(0.0, 1.5), weights=x)[0]
        np.histogram(y, 3, density=True)[0]
        np.histogram(y, 3)[1]
        np.histogram(y, bins=g, weights=x)[0]
        m[np.ix_(p, p)]
    """,
    "given a function": """
        np.piecewise(x, [x < 0.5], [np.sin, 1.0])
        np.vectorize(lambda v: v * v + 1.0)(x) * np.vectorize(lambda v: v, otypes=[float])(x)
        np.apply_along_axis(np.sum, 0, m)
        x * np.fromfunction(lambda i: i * i, (4,))
    """,
    "order and selection": """
        np.sort(x) * y
        np.sort(m, axis=0) * m
        np.take(x, p) * y
        np.take(m, p, axis=1) * m
        np.take_along_axis(m, np.argsort(m, axis=1), axis=1) * m
        m.flat[5] * x
        x.item(2) * y
        np.where(x > 0.5, x, y)
        np.select([x > 0.7, x > 0.4], [x, x * y], 0.0)
        np.nan_to_num(x)
        np.extract(x > 0.5, x)
        np.compress(x > 0.5, x)
        np.choose(p % 2, [x, y])
        np.unique(x)
        0.0; b, i = np.unique(x, return_index=True); b * y[i]
        0.0; b, i = np.unique(x, return_inverse=True); b[i] * y
        0.0; b, i = np.unique(x, return_counts=True); b * i
        m.diagonal() * np.diagonal(m)
        np.tril(m) * np.triu(m, -1)
        np.clip(x, 0.3, 0.8) * x.clip(0.3, 0.8)
    """,
    "sums and differences": """
        np.unwrap(9.0 * x)
        np.diff(x)
        np.diff(m, axis=0)
        np.diff(x, 2)
        np.ediff1d(x)
        np.gradient(x)
        np.gradient(x, 0.5)
        np.gradient(m, axis=0)
        np.trapezoid(y, x)
        np.trapezoid(m, dx=0.5, axis=0)
        np.interp(x, g, y)
        np.convolve(x, y)
        np.convolve(x, y, mode="same")
        np.convolve(x, y, mode="valid")
        np.correlate(x, y)
        np.correlate(x, y, mode="full")
        np.polyval(y, x)
        np.polynomial.polynomial.polyval(x, y)
        np.polyfit(np.arange(4.0), x, 2)
        np.polyder(x)
        np.polyint(x)
        np.polymul(x, y)
        np.polyadd(x, y[:2]) * np.polysub(x[:3], y)
        np.poly1d(x); (z * z + z)(0.5)
        np.polynomial.Polynomial(x)(y[0])
        np.polynomial.chebyshev.chebval(x, y)
        np.polynomial.legendre.legval(x, y)
        np.polynomial.hermite.hermval(x, y)
        np.polynomial.hermite_e.hermeval(x, y)
        np.polynomial.laguerre.lagval(x, y)
        x * np.polynomial.legendre.leggauss(4)[0] * np.polynomial.chebyshev.chebgauss(4)[1]
        x * np.polynomial.hermite.hermgauss(4)[0] * np.polynomial.hermite_e.hermegauss(4)[1]
        x * np.polynomial.laguerre.laggauss(4)[0]
        np.ldexp(x, 2)
        np.cross(x[:3], y[:3])
    """,
}
