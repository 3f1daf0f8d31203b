"""Masonry arches by discontinuous deformation analysis and by theory.

Modules
-------
theory
    The analytic solutions of the Couplet-Heyman problem, computed by the Fortran module of the
    build.
"""

__version__ = "0.1.0"
