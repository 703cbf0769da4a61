"""Jacobians, sparse ones too, and second derivatives, from products of one point."""
from s2sad.jacobians.jacobian import (
    Jacobian as Jacobian, ValueAndJacobian as ValueAndJacobian, jacobian as jacobian,
    value_and_jacobian as value_and_jacobian,
)
from s2sad.jacobians.second_order import Hessian as Hessian, hessian as hessian, hvp as hvp
