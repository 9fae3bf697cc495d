"""lsoda: SciPy's LSODA, Adams methods of variable order up to 12 that give way to BDF up to 5 where a scene is stiff; scipy_methods.py."""

from scipy import integrate

from rigid_body_sim.integrators.families import scipy_methods as FAMILY  # noqa: F401, N812

NAME = 'lsoda'
ORDER = 12
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
TAKES = ('accuracy',)
SOLVER = integrate.LSODA
SOURCE = 'L. Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; ODEPACK, by SciPy'
