"""differentiate: normal form becomes an adjoint or a tangent, statement by statement."""
