"""A kernel for the page of `explain`: a record, a helper, and a text that a careless page would take for its own."""


def squares(u, n):
    """Ends no script: </script><img src=x onerror=alert(1)> & "quotes" — λ."""
    total = 0.0
    for _ in range(n):
        for i in range(u.size):
            u[i] = u[i] * u[i]
    for i in range(u.size):
        total += halved(u[i],
                        n)
    return total


def halved(x, n):
    return 0.5 * x if n > 0 else x
