"""Kernels as functions of PyTorch: values, derivatives of both modes, second ones, and what is refused."""
from __future__ import annotations

import pickle

import numpy as np
import pytest
import torch

import s2sad
from s2sad.bridges import torch_steps
from tests.bridges import kernels

U, RATE = np.array([1.0, -0.5, 0.3, 2.0]), 0.4
ENGINES = pytest.mark.parametrize("engine", ["numpy", "numba"])
TWICE = ("error[S401]: PyTorch asks for a derivative of a derivative of '{}'\n  help: there are second derivatives, "
         "backwards twice, of a function that returns one float: write one that returns the loss")


def bridged(f, engine="numpy", **options):
    return s2sad.torch(s2sad.differentiate(f, engine=engine), **options)


def given(value, grad=True):
    return torch.tensor(value, dtype=torch.float64, requires_grad=grad)


def relaxed(u, rate):
    u = np.array(u)
    kernels.relax(u, rate)
    return u


@ENGINES
def test_values_and_gradients(engine):
    k, u, rate, seed = bridged(kernels.relax, engine), given(U), given(RATE), np.arange(1.0, 5.0)
    found = k(u, rate)
    np.testing.assert_array_equal(found.detach(), relaxed(U, RATE))
    np.testing.assert_array_equal(u.detach(), U)
    (found * torch.from_numpy(seed)).sum().backward()
    wanted = s2sad.vjp(kernels.relax, (U, RATE), {"u": seed})
    np.testing.assert_allclose(u.grad, wanted["u"], rtol=1e-15)
    np.testing.assert_allclose(rate.grad, wanted["rate"], rtol=1e-15)
    torch.autograd.gradcheck(k, (u, rate), check_forward_ad=True)
    torch.autograd.gradcheck(lambda u: k(u, RATE), (u,))


@ENGINES
def test_several_outputs(engine):
    k = bridged(kernels.several, engine)
    u, out, c = given(np.array([1.0, 4.0, 9.0])), torch.zeros(3, dtype=torch.float64), given(2.0)
    found = k(u, out, c, mode="shifted")
    np.testing.assert_array_equal(found["out"].detach(), [3.0, 32.0, 162.0])
    assert found["return"][0].item() == 2.0 and found["return"][2] is None
    (3.0 * found["return"][1]).sum().backward()
    np.testing.assert_allclose(u.grad, [0.0, 0.75, 0.5])
    assert c.grad.item() == 0.0


def test_tensors_and_arrays_share_their_memory():
    u = given(U)
    array = torch_steps._array(u)
    array[0] = 7.0
    assert u[0].item() == 7.0
    assert torch_steps._tensor(array, u.dtype).data_ptr() == u.data_ptr()


@ENGINES
def test_second_derivatives_of_one_float(engine):
    k, u, w = bridged(kernels.energy, engine), given(U), given(2.0)
    torch.autograd.gradgradcheck(k, (u, w))
    wanted = s2sad.hessian(kernels.energy, wrt="u")(U, 2.0)
    for outer in (torch.func.jacrev, torch.func.jacfwd):
        found = outer(torch.func.jacrev(lambda u: 3.0 * k(u, 2.0)))(u.detach())
        np.testing.assert_allclose(found, 3.0 * wanted, rtol=1e-14)


def test_other_derivatives_of_derivatives_are_refused():
    k, energy, u, w = bridged(kernels.relax), bridged(kernels.energy), given(U), given(2.0)
    for call in (lambda: torch.autograd.grad(torch.autograd.grad(k(u, RATE).sum(), u, create_graph=True)[0].sum(), u),
                 lambda: torch.func.jacrev(torch.func.jacfwd(lambda u: k(u, RATE)))(u.detach()),
                 lambda: torch.func.jacfwd(torch.func.jacrev(lambda u: k(u, RATE)))(u.detach())):
        with pytest.raises(s2sad.S2sadError) as caught:
            call()
        assert str(caught.value) == TWICE.format("relax")
    slope, = torch.autograd.grad(energy(u, w), u, create_graph=True)
    second, = torch.autograd.grad(slope.sum(), u, create_graph=True)
    with pytest.raises(s2sad.S2sadError) as caught:
        second.sum().backward()
    assert str(caught.value) == TWICE.format("energy")


def test_vmap_and_jvp():
    k, many = bridged(kernels.relax), torch.from_numpy(np.stack([U, 2.0 * U, -U]))
    slopes = torch.func.vmap(torch.func.grad(lambda u, r: (k(u, r) ** 2).sum()), in_dims=(0, None))
    for row, u in zip(slopes(many, given(RATE, False)), many.numpy()):
        np.testing.assert_allclose(row, s2sad.vjp(kernels.relax, (u, RATE), {"u": 2.0 * relaxed(u, RATE)})["u"])
    _, tangent = torch.func.jvp(k, (given(U, False), given(RATE, False)), (torch.ones(4, dtype=torch.float64), given(
        2.0, False)))
    np.testing.assert_allclose(tangent, s2sad.jvp(kernels.relax, (U, RATE), {"u": np.ones(4), "rate": 2.0})["u"])


def test_other_dtypes_and_layouts():
    z, c = torch.tensor([1.0 + 1.0j, 2.0 - 0.5j], dtype=torch.complex128, requires_grad=True), 0.5 - 2.0j
    torch.autograd.gradcheck(lambda z: tuple(bridged(kernels.rotated)(z, c).values()), (z,))
    single = torch.tensor(U, dtype=torch.float32, requires_grad=True)
    bridged(kernels.halved)(single).sum().backward()
    assert single.grad.tolist() == [0.5] * 4 and single.grad.dtype == torch.float32
    wide = given(np.stack([U, U], axis=1))
    k = bridged(kernels.relax)
    k(wide[:, 1], RATE)[2].backward()
    np.testing.assert_allclose(wide.grad[:, 1], s2sad.vjp(kernels.relax, (U, RATE), {"u": np.eye(4)[2]})["u"])
    one = given([0.5])
    k(one.expand(4), RATE).sum().backward()
    assert one.grad.item() == 4.0
    np.testing.assert_array_equal(bridged(kernels.pick)(given(U), torch.tensor(3)).detach(), 4.0)


@pytest.mark.parametrize("f, options, args, said", [
    (kernels.relax, {"wrt": "u"}, (given(U), given(RATE)), "error[S401]: PyTorch differentiates 'relax' with respect "
     "to 'rate', which is not in wrt\n  help: name it, wrt=(..., \"rate\"), or hold it fixed: rate.detach()"),
    (kernels.relax, {}, (given(U).to("meta"), RATE), "error[S405]: the argument 'u' of 'relax' is on the device meta, "
     "and kernels run on the CPU\n  help: pass u.cpu()"),
    (kernels.relax, {}, (given(U).bfloat16(), RATE), "error[S405]: the argument 'u' has dtype bfloat16\n"
     "  help: use float64, float32, complex128, an integer type or bool"),
    (kernels.root, {}, (given(-1.0),), "a root of less than zero"),
    (kernels.pick, {}, (given(U), 4), "index 4 is out of bounds for axis 0 with size 4")])
def test_what_is_refused_or_raised(f, options, args, said):
    with pytest.raises((s2sad.S2sadError, ValueError, IndexError)) as caught:
        bridged(f, **options)(*args)
    assert str(caught.value) == said


def test_a_copy_is_the_same_function():
    copied = pickle.loads(pickle.dumps(bridged(kernels.relax)))
    assert repr(copied) == "<relax of PyTorch>"
    np.testing.assert_array_equal(copied(given(U, False), RATE), relaxed(U, RATE))


def test_a_network_and_a_kernel_train_together():
    """The network gives a start, the kernel smooths it in place at a rate that is trained, too."""
    torch.manual_seed(0)
    kernel, x = bridged(kernels.relax, "numba"), torch.linspace(0.0, 1.0, 16, dtype=torch.float64)
    target = torch.from_numpy(relaxed(relaxed(np.sin(7.0 * x.numpy()), 0.7), 0.7))
    network = torch.nn.Sequential(torch.nn.Linear(1, 8), torch.nn.Tanh(), torch.nn.Linear(8, 1)).double()
    rate = given(0.2)
    steps = torch.optim.Adam([*network.parameters(), rate], lr=0.05)
    losses = []
    for _ in range(300):
        steps.zero_grad()
        loss = ((kernel(kernel(network(x[:, None])[:, 0], rate), rate) - target) ** 2).mean()
        loss.backward()
        steps.step()
        losses.append(loss.item())
    assert losses[-1] < 0.1 * losses[0] and rate.item() != 0.2
