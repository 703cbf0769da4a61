"""Kernels as functions of JAX: values, derivatives and errors under both engines, through its transformations."""
from __future__ import annotations

import pickle
import threading

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import s2sad
from s2sad.bridges import xla_calls
from tests.bridges import kernels

jax.config.update("jax_enable_x64", True)
U, RATE = np.array([1.0, -0.5, 0.3, 2.0]), 0.4
ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])


def bridged(f, engine="numpy", **options):
    return s2sad.jax(s2sad.differentiate(f, engine=engine), **options)


def relaxed(u, rate):
    u = np.array(u)
    kernels.relax(u, rate)
    return u


@ENGINES
def test_what_is_written_comes_back_and_no_argument_changes(engine):
    k, u = bridged(kernels.relax, engine), jnp.array(U)
    for found in (k(u, RATE), jax.jit(k)(u, RATE), k(U, np.float64(RATE))):
        np.testing.assert_array_equal(found, relaxed(U, RATE))
    np.testing.assert_array_equal(u, U)


@ENGINES
def test_gradients_are_those_of_s2sad_and_of_differences(engine):
    k, seed = bridged(kernels.relax, engine), np.arange(1.0, 5.0)

    def loss(u, rate):
        return jnp.vdot(k(u, rate), seed)
    wanted = s2sad.vjp(kernels.relax, (U, RATE), {"u": seed})
    for grad in (jax.grad(loss, (0, 1)), jax.jit(jax.grad(loss, (0, 1)))):
        u_bar, rate_bar = grad(jnp.array(U), RATE)
        np.testing.assert_allclose(u_bar, wanted["u"], rtol=1e-15)
        np.testing.assert_allclose(rate_bar, wanted["rate"], rtol=1e-15)
    difference = (relaxed(U, RATE + 1e-6) - relaxed(U, RATE - 1e-6)) @ seed / 2e-6
    np.testing.assert_allclose(wanted["rate"], difference, rtol=1e-8)
    np.testing.assert_allclose(jax.grad(loss)(U, RATE), wanted["u"], rtol=1e-15)


@ENGINES
def test_tangents(engine):
    k = bridged(kernels.relax, engine, forward=True)
    wanted = s2sad.jvp(kernels.relax, (U, RATE), {"u": np.ones(4), "rate": 2.0})["u"]
    value, tangent = jax.jit(lambda u, r: jax.jvp(k, (u, r), (jnp.ones(4), 2.0)))(U, RATE)
    np.testing.assert_array_equal(value, relaxed(U, RATE))
    np.testing.assert_allclose(tangent, wanted, rtol=1e-15)
    np.testing.assert_allclose(jax.jacfwd(k)(U, RATE), s2sad.jacobian(kernels.relax, "u")(U, RATE), rtol=1e-15)
    with pytest.raises(ValueError, match="cannot be differentiated"):
        jax.grad(lambda r: k(U, r).sum())(RATE)


@ENGINES
def test_several_outputs_and_constants(engine):
    k, out = bridged(kernels.several, engine), np.zeros(4)
    u = np.array([1.0, 4.0, 9.0, 16.0])
    found = k(u, out, 2.0, mode="shifted")
    np.testing.assert_array_equal(found["out"], 2.0 * u * u + [1.0, 0.0, 0.0, 0.0])
    number, roots, nothing = found["return"]
    assert (number, nothing) == (2.0, None)
    np.testing.assert_array_equal(roots, [2.0, 3.0, 4.0])

    def loss(u, c, one=1.0):
        made = k(u, out, c)
        return jnp.sum(made["out"]) + one * (made["return"][0] + 3.0 * jnp.sum(made["return"][1]))
    roots = np.array([0.0, *(1.5 / np.sqrt(u[1:]))])
    np.testing.assert_allclose(jax.grad(loss)(u, 2.0), 4.0 * u + roots + [2.0, 0.0, 0.0, 0.0], rtol=1e-15)


def test_outputs_that_do_not_count():
    k, u, out = bridged(kernels.several), np.array([1.0, 4.0, 9.0]), np.zeros(3)
    assert jax.grad(lambda c: k(u, out, c)["return"][0])(2.0) == 1.0
    assert jax.grad(lambda out: k(u, out, 1.0)["out"].sum())(out).tolist() == [0.0] * 3
    only = bridged(kernels.several, of="out")
    np.testing.assert_array_equal(only(u, out, 1.0), u * u)
    np.testing.assert_array_equal(jax.grad(lambda u: only(u, out, 1.0).sum())(u), 2.0 * u)


@ENGINES
def test_transformations(engine):
    k = bridged(kernels.relax, engine)
    jax.jit(jax.grad(lambda u, r: k(u, r).sum(), (0, 1)))(U, RATE)      # JAX keeps what it traced here for what follows
    many = np.stack([U, 2.0 * U, -U])
    batched = jax.vmap(jax.grad(lambda u, r: (k(u, r) ** 2).sum()), in_axes=(0, None))(many, RATE)
    for row, u in zip(batched, many):
        np.testing.assert_allclose(row, s2sad.vjp(kernels.relax, (u, RATE), {"u": 2.0 * relaxed(u, RATE)})["u"])

    def steps(rate, wrap):
        return jax.lax.scan(lambda u, _: (wrap(k)(u, rate), None), jnp.array(U), None, length=3)[0].sum()

    def plain(rate):
        return relaxed(relaxed(relaxed(U, rate), rate), rate).sum()
    for wrap in (lambda k: k, jax.checkpoint):
        found = jax.jit(jax.grad(steps), static_argnums=1)(RATE, wrap)
        np.testing.assert_allclose(found, (plain(RATE + 1e-5) - plain(RATE - 1e-5)) / 2e-5, rtol=1e-8)
    picked = bridged(kernels.pick, engine)
    np.testing.assert_array_equal(jax.vmap(picked, in_axes=(None, 0))(U, jnp.arange(4)), U * U)
    np.testing.assert_array_equal(jax.jit(jax.grad(picked))(U, 3), [0.0, 0.0, 0.0, 4.0])


@ENGINES
def test_complex_numbers_are_transposed_as_jax_does(engine):
    k = bridged(kernels.rotated, engine)
    z, c, seed = np.array([1.0 + 1.0j, 2.0 - 0.5j]), 0.5 - 2.0j, jnp.array([1.0j, 2.0 + 1.0j])

    def same(z, c):
        z = c * z * z
        return {"z": z, "return": z[0] * (1.0 + 2.0j)}
    (value, pull), (wanted, pulled) = jax.vjp(k, z, c), jax.vjp(same, z, c)
    np.testing.assert_allclose(value["z"], wanted["z"], rtol=1e-15)
    for ours, theirs in zip(pull({"z": seed, "return": 1.0 + 1.0j}), pulled({"z": seed, "return": 1.0 + 1.0j})):
        np.testing.assert_allclose(ours, theirs, rtol=1e-14)


@ENGINES
def test_single_precision(engine):
    k = bridged(kernels.halved, engine)
    found = jax.jit(jax.grad(lambda u: (k(u) ** 2).sum()))(jnp.array(U, jnp.float32))
    assert found.dtype == jnp.float32
    np.testing.assert_allclose(found, 0.5 * U, rtol=1e-6)


@ENGINES
def test_what_the_kernel_raises_is_an_error_of_jax(engine):
    k = bridged(kernels.root, engine)
    assert (k(4.0), jax.jit(jax.grad(k))(4.0)) == (2.0, 0.25)
    for call in (k, jax.jit(k), jax.grad(k)):
        with pytest.raises(Exception) as caught:
            jax.block_until_ready(call(-1.0))
        assert str(caught.value) == "INVALID_ARGUMENT: ValueError: a root of less than zero"
    assert k(9.0) == 3.0


@ENGINES
def test_an_index_out_of_bounds_is_an_error(engine):
    k = bridged(kernels.pick, engine)
    said = {"numpy": "IndexError: index ", "numba": f"S2sadIndexError: {kernels.__file__}:"}[engine]
    for call in (k, jax.jit(k), jax.jit(jax.grad(k))):
        with pytest.raises(Exception) as caught:
            jax.block_until_ready(call(U, 4))
        assert str(caught.value).startswith(f"INVALID_ARGUMENT: {said}")
    with pytest.raises(Exception) as caught:
        jax.block_until_ready(bridged(kernels.gathered, engine)(U, np.array([0, 7])))
    assert str(caught.value).startswith(f"INVALID_ARGUMENT: {said}")
    np.testing.assert_array_equal(jax.grad(bridged(kernels.gathered, engine))(U, np.array([0, 0, 3])), [4, 0, 0, 4])


@ENGINES
def test_an_array_of_the_module_is_read_at_each_call(engine, monkeypatch):
    k = bridged(kernels.weighted, engine)
    np.testing.assert_allclose(jax.grad(k)(U), 2.0 * np.array([1.0, 2.0, 3.0, 4.0]) * U)
    monkeypatch.setattr(kernels, "TABLE", np.array([9.0, 2.0, 3.0, 4.0]))
    np.testing.assert_allclose(jax.grad(k)(U), 2.0 * np.array([9.0, 2.0, 3.0, 4.0]) * U)
    kernels.TABLE[0] = 7.0
    np.testing.assert_allclose(jax.grad(k)(U), 2.0 * np.array([7.0, 2.0, 3.0, 4.0]) * U)


def test_shapes_of_results_follow_from_shapes_and_integers():
    k = bridged(kernels.made)
    assert k(U, 2).shape == (2,) and k(U, 3).shape == (3,) and jax.jit(lambda u: k(u, 5))(U).shape == (5,)
    said = ("error[S405]: the shape of what '{}' returns is known only once it has run\n"
            "  help: write it into an argument, whose shape JAX knows")
    for call, name in ((lambda: jax.jit(k)(U, 2), "made"), (lambda: bridged(kernels.positive)(U), "positive")):
        with pytest.raises(s2sad.S2sadError) as caught:
            call()
        assert str(caught.value) == said.format(name)


def test_integers_and_functions_are_arguments():
    k = bridged(kernels.pick)
    k(U, 0)
    before = len(xla_calls._KEPT)
    assert [float(k(U, n)) for n in range(4)] == (U * U).tolist() and len(xla_calls._KEPT) == before
    assert jax.grad(bridged(kernels.applied), argnums=1)(np.sin, 1.0) == np.sin(1.0) + np.cos(1.0)


def test_what_wrt_does_not_name_has_no_silent_zero():
    k = bridged(kernels.relax, wrt="u")
    assert jax.grad(lambda u: k(u, RATE)[2])(U).tolist() == [*s2sad.vjp(kernels.relax, (U, RATE), {
        "u": np.array([0.0, 0.0, 1.0, 0.0])})["u"]]
    with pytest.raises(s2sad.S2sadError) as caught:
        jax.grad(lambda r: k(U, r)[2])(RATE)
    assert str(caught.value) == (
        "error[S401]: JAX differentiates 'relax' with respect to 'rate', which is not in wrt\n"
        '  help: name it, wrt=(..., "rate"), or hold it fixed: jax.lax.stop_gradient(rate)')
    assert jax.grad(lambda r: k(U, jax.lax.stop_gradient(r))[2] * r)(RATE) == relaxed(U, RATE)[2]


@pytest.mark.parametrize("args, said", [
    (([1.0, 2.0], 1.0), "error[S405]: the argument 'u' is a list\n  help: pass numpy.array(u, dtype=float)"),
    ((jnp.ones(3, jnp.float16), 1.0), "error[S405]: the argument 'u' has dtype float16\n"
     "  help: use float64, float32, complex128, an integer type or bool"),
    ((jnp.arange(3), 1.0), "error[S401]: 'relax' has nothing to differentiate: it writes no float array and returns no "
     "float\n  note: 'u' is an array of int64\n  help: pass u.astype(float) if it holds real quantities")])
def test_what_a_kernel_does_not_take(args, said):
    with pytest.raises(s2sad.S2sadError) as caught:
        bridged(kernels.relax)(*args)
    assert str(caught.value) == said


def test_float64_has_to_be_enabled():
    said = ("error[S405]: {} of float64, which JAX does not have as it is set\n"
            '  help: say jax.config.update("jax_enable_x64", True) first, or work in float32')
    jax.config.update("jax_enable_x64", False)
    try:
        for f, args, what in (
                (kernels.relax, (U, RATE), "the argument 'u' of 'relax' is"),
                (kernels.root, (2.0,), "what 'root' returns is"),
                (kernels.weighted, (jnp.ones(4),), "the argument 'TABLE' of 'weighted' is")):
            with pytest.raises(s2sad.S2sadError) as caught:
                bridged(f)(*args)
            assert str(caught.value) == said.format(what)
        np.testing.assert_array_equal(bridged(kernels.halved)(jnp.array(U, jnp.float32)), 0.5 * U.astype(np.float32))
    finally:
        jax.config.update("jax_enable_x64", True)


def test_callbacks_take_the_place_of_handlers(monkeypatch):
    monkeypatch.setattr(xla_calls, "minor_version", lambda: None)
    k = bridged(kernels.energy)
    wanted = s2sad.gradient(kernels.energy, wrt=("u", "w"))(U, 2.0)
    u_bar, w_bar = jax.jit(jax.grad(k, (0, 1)))(U, 2.0)
    np.testing.assert_array_equal(u_bar, wanted["u"])
    assert w_bar == wanted["w"]
    many = jax.vmap(k, in_axes=(None, 0))(U, jnp.arange(3.0))
    np.testing.assert_allclose(many, [kernels.energy(U, w) for w in range(3)])


def test_threads_and_copies():
    k, found = bridged(kernels.relax, "numba"), {}
    copied = pickle.loads(pickle.dumps(k))
    assert repr(copied) == "<relax of JAX>"

    def call(n):
        found[n] = [np.asarray(copied(U + n, RATE)) for _ in range(20)]
    threads = [threading.Thread(target=call, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for n in range(4):
        np.testing.assert_array_equal(found[n], [relaxed(U + n, RATE)] * 20)


def test_a_network_and_a_kernel_train_together():
    """The network gives a start, the kernel smooths it in place at a rate that is trained, too."""
    kernel, x = bridged(kernels.relax, "numba"), np.linspace(0.0, 1.0, 16)
    target = relaxed(relaxed(np.sin(7.0 * x), 0.7), 0.7)
    keys = jax.random.split(jax.random.PRNGKey(0), 2)
    weights = {"a": 4.0 * jax.random.normal(keys[0], (1, 8)), "b": jnp.zeros(8),
               "c": 0.3 * jax.random.normal(keys[1], (8,)), "rate": 0.2}

    @jax.jit
    @jax.value_and_grad
    def loss(weights):
        start = jnp.tanh(x[:, None] @ weights["a"] + weights["b"]) @ weights["c"]
        return jnp.mean((kernel(kernel(start, weights["rate"]), weights["rate"]) - target) ** 2)
    first = loss(weights)[0]
    for _ in range(400):
        last, slopes = loss(weights)
        weights = jax.tree.map(lambda w, s: w - 0.2 * s, weights, slopes)
    assert last < 0.2 * first
