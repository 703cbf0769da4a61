"""Derivatives that users give: rules by partials, adjoints, tangents, pairs of halves, residuals of implicit
functions.
"""
