# SPDX-License-Identifier: Apache-2.0
"""Processors that numba compiles for in place of this one: settings of its environment."""

AVX2 = '+sse3,+ssse3,+sse4.1,+sse4.2,+popcnt,+avx,+avx2,+fma,+f16c,+bmi,+bmi2,+lzcnt,+movbe'
AVX512 = f'{AVX2},+avx512f,+avx512cd,+avx512bw,+avx512dq,+avx512vl'


def _target(name, features):
    return {'NUMBA_CPU_NAME': name, 'NUMBA_CPU_FEATURES': features}


TARGETS = {'generic': _target('generic', ''), 'avx2': _target('haswell', AVX2),
           'avx512': _target('skylake-avx512', AVX512)}
"""Settings by name: any x86-64, one with AVX2 and FMA, one with AVX-512."""
