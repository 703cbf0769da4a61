"""Which states of a loop are kept when it is run again from them: Revolve, and thinning where its length is not known.

Revolve: Griewank and Walther, ACM Transactions on Mathematical Software 26, 2000.
"""
from __future__ import annotations

import numpy as np


def revolve(step, end, free):
    """The step before which the next state is kept on the way from one that is held, that before `step`, to the last
    one in front of `end`, with `free` places left; `end` if none is.

    The steps between are run again as few times as can be: with s places n steps are run t n - C(s + t, s + 1) times
    before their turn, where C(s + t - 1, s) < n <= C(s + t, s).

    >>> revolve(0, 10, 2), revolve(4, 10, 1), revolve(6, 10, 0)
    (4, 7, 10)
    """
    steps, places = end - step, free + 1
    if free < 1 or steps < 2:
        return end
    repeats, before, less, most = 0, 0, 0, 1
    while most < steps:  # C(places + repeats, places) steps can be reversed
        repeats += 1
        before, less, most = less, most, most * (places + repeats) // repeats
    return step + max(before, steps - (most - less), min(less, steps - (less - before)), 1)


def crowded(step, gap, places):
    """Whether half of the states suffice, of those before steps 0, gap, 2 gap, ..., if the loop ends
    in the middle of the next gap: then fewer steps are run again, for more places are free.

    >>> [step for step in range(40) if crowded(step, 1, 8)][:1], crowded(32, 4, 8), crowded(24, 4, 8)
    ([8], True, False)
    """
    count = step // gap
    if count >= places:
        return True
    if count % max(1, places // 16) > 0:  # it need not be asked often
        return False
    steps = step + gap // 2 + 1
    return runs_again(steps, 2 * gap, places) < runs_again(steps, gap, places)


def runs_again(steps, gap, places):
    """How many runs of steps it takes to reverse them, where those of 0, gap, 2 gap, ... are held.

    >>> runs_again(1000, 1000, 20), runs_again(1000, 100, 20), runs_again(4, 1, 4)
    (2747, 1856, 0)
    """
    runs = 0
    for start in range(0, steps, gap):
        length = min(gap, steps - start)
        repeats, most = 0, 1
        while most < length:
            repeats += 1
            most = most * (places + repeats) // repeats
        runs += repeats * length - most * repeats // (places + 1)
        places -= 1
    return runs


def thin(kept, count):
    """The number of states that are left where every second one of the first `count` is kept, moved to the front.

    >>> import numpy as np
    >>> kept = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    >>> thin(kept, 4), kept[:2]
    (2, array([0., 2.]))
    """
    for place in range((count + 1) // 2):
        kept[place] = kept[2 * place]
    return (count + 1) // 2


def on_disk(array, rows, folder):
    """Room for so many copies of an array in a file of a folder, where it has no name and is gone
    with the last reference to it; raises OSError if it cannot be had.

    >>> import tempfile
    >>> on_disk(np.ones((3, 4)), 2, tempfile.gettempdir()).shape
    (2, 3, 4)
    """
    import tempfile

    with tempfile.TemporaryFile(dir=folder) as file:
        return mapped(file, array, rows, folder)


def mapped(file, array, rows, folder):
    """Memory for so many copies of an array that is mapped to a file, which has room for them."""
    import mmap

    size = max(1, rows * array.nbytes)
    extend(file, size, folder)
    content = mmap.mmap(file.fileno(), size)
    return np.ndarray((rows,) + array.shape, array.dtype, content)


def extend(file, size, folder):
    """Gives an empty file so many bytes; raises OSError if there is no room for them."""
    import os
    import shutil

    free = shutil.disk_usage(folder).free
    if free < size:
        raise OSError(28, f"{size:,} bytes are needed, {free:,} are free", folder)
    if hasattr(os, "posix_fallocate"):  # the room is taken now: a page without would end the process
        os.posix_fallocate(file.fileno(), 0, size)
    else:
        file.truncate(size)
