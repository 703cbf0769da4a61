"""iterators: what the iterators of itertools give, each when it is asked, and what operator's callables do.

    for a, b in itertools.pairwise(x): s += a * b       ->      before = x[0], and b = x[k] behind it
"""
from __future__ import annotations

_END = "the end of an iterator"


def count(start=0, step=1):
    k = start
    while True:
        yield k
        k += step


def cycle(iterable):
    saved = []
    for item in iterable:
        yield item
        saved.append(item)
    while True:
        for item in saved:
            yield item


def repeat(object):
    while True:
        yield object


def pairwise(iterable):
    last = None
    for item in iterable:
        if last is not None:
            yield last, item
        last = item


def islice(iterable, start, stop, step):
    for k, item in enumerate(iterable):
        if k >= start and (k - start) % step == 0:
            yield item
        if stop is not None and k == stop - 1:
            break


def takewhile(predicate, iterable):
    for item in iterable:
        if not predicate(item):
            break
        yield item


def starmap(function, iterable):
    for item in iterable:
        yield function(*item)


def groupby(iterable, key=None):
    iterator = iter(iterable)
    is_left, item, found, groups = True, None, None, 0

    def advance():
        nonlocal is_left, item, found
        item = next(iterator, _END)
        is_left = item is not _END
        if is_left:
            found = item if key is None else key(item)

    def group(number, target):
        while is_left and number == groups and found == target:
            yield item
            advance()
    advance()
    while is_left:
        target = found
        yield target, group(groups, target)
        while is_left and found == target:      # what has not been taken is gone
            advance()
        groups += 1


def zip_longest(*iterables, fillvalue=None):
    columns = [list(iterable) if isinstance(iterable, (dict, set)) else iterable for iterable in iterables]
    k = 0
    while any(k < len(column) for column in columns):
        yield tuple([column[k] if k < len(column) else fillvalue for column in columns])
        k += 1


def itemgetter(*items):
    def get(obj):
        return obj[items[0]] if len(items) == 1 else tuple([obj[item] for item in items])
    return get


def attrgetter(*attrs):
    def resolved(obj, attr):
        for name in attr.split("."):
            obj = getattr(obj, name)
        return obj

    def get(obj):
        return resolved(obj, attrs[0]) if len(attrs) == 1 else tuple([resolved(obj, attr) for attr in attrs])
    return get


def methodcaller(name, *args, **kwargs):
    def called(obj):
        return getattr(obj, name)(*args, **kwargs)
    return called


def from_iterable(iterable):
    for items in iterable:
        yield from items
